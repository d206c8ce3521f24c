#pragma once
// A comparison for scripts, for pages and for a terminal.

#include <filesystem>
#include <string>
#include <vector>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/lot/fleet_lot.hpp"
#include "libchar/replay/comparison.hpp"

namespace libchar {

/// The keys after the head of {"format":"replay-comparison","version":1,…} (docs/replay.md).
Json comparison_json(const Comparison& comparison);

/// A table of the algorithms that ran, with what is unlike above it and the verdict below.
std::string comparison_text(const Comparison& comparison, std::size_t width = 0);

/// One page of Markdown.
std::string comparison_markdown(const Comparison& comparison);

/// Why an algorithm has no change, as far as the reports say: "only in A", "skipped in B"; empty when it ran in both.
std::string side_of(const ComparedAlgorithm& row);

// Two lots side by side, for scripts and a terminal.

/// {"format":"fleet-comparison",…}
Json fleet_comparison_json(const FleetComparison& comparison, const std::vector<std::string>& command = {},
                           const std::vector<LogInfo>& inputs = {});
std::string fleet_comparison_text(const FleetComparison& comparison, std::size_t width = 0);

// Characterizations, models and curves side by side: for scripts, papers, a terminal, and as a page.

/// The keys after the head of {"format":"characterization-comparison","version":1,…} (docs/recordings.md).
Json comparison_json(const CharacterizationComparison& comparison);

std::string comparison_text(const CharacterizationComparison& comparison, std::size_t width = 0);
/// One page of Markdown.
std::string comparison_markdown(const CharacterizationComparison& comparison);

namespace detail {

/// Which groups a table has.
enum class TableGroups {
  summary,  ///< axes together where they are compared so, each channel otherwise
  axes,     ///< what `summary` leaves out
  all,
};

/// N, B, K and the Allan deviation at some averaging times, one row per sensor and channel; what is lowest is marked.
Table comparison_table(const CharacterizationComparison& comparison, TableGroups groups = TableGroups::summary);

/// One page of HTML: verdict, a figure for each quantity, the table; `document` is what it can save.
std::string comparison_html(const CharacterizationComparison& comparison, const Json& document,
                            const std::vector<std::string>& command);

}  // namespace detail

// A run of benchmarks against an older one: what is better or worse beyond both intervals.

struct BenchChange {
  std::string what;  ///< "noise coefficients, white noise alone: sensorchar, ns per sample"
  bool is_time = false;
  Figure was, now;
  double ratio = 1;       ///< now over was
  bool resolved = false;  ///< the intervals do not meet
};

struct BenchChanges {
  std::vector<BenchChange> figures;  ///< that are in both
  bool same_machine = false;         ///< processor and their number
  std::vector<std::string> missing;  ///< that are in the older one only
  /// Worse and resolved, by more than `tolerance` of it: errors always, times on the same machine only and by three of
  /// it.
  std::vector<BenchChange> worse(double tolerance) const;
};

/// Throws Error(input) for an older one of other records and runs: its figures would be of something else.
BenchChanges bench_changes(const BenchReport& was, const BenchReport& now, const std::string& file);

std::string changes_text(const BenchChanges& changes, double tolerance);
Json changes_json(const BenchChanges& changes, double tolerance);

// Benchmarks as files and for a terminal.

std::string bench_text(const BenchReport& report);
std::string bench_markdown(const BenchReport& report);
/// `next`: what to type next.
std::string bench_html(const BenchReport& report, const std::vector<std::string>& next = {});

/// The page, the document and the Markdown, named bench, in this folder.
std::vector<OutputFile> bench_files(const BenchReport& report, const std::filesystem::path& folder,
                                    const std::vector<std::string>& next = {});

}  // namespace libchar
