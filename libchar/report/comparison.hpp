#pragma once
// Two replay reports side by side: what a change of code or options did to errors and costs.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/json.hpp"

namespace libchar {

/// One algorithm of a report.
struct ReportedAlgorithm {
  std::string label;
  bool ran = false, bound = false;
  std::string why;  ///< why it did not run
  /// RMSE, or leave-one-out RMS without a reference.
  std::optional<double> score;
  std::optional<Interval> score_ci95;
  std::optional<double> regret, ns_per_sample, peak_bytes;
};

/// What a comparison takes from a report.json of `replay`.
struct ReportedReplay {
  std::string file;
  std::string scene;  ///< name, or file
  std::string score;  ///< "rmse" or "leave_one_out_rms"
  std::string unit;   ///< of the score
  /// What makes two scenes alike: a phrase and its value, in the order in which differences are
  /// told.
  std::vector<std::pair<std::string, std::string>> identity;
  std::vector<ReportedAlgorithm> algorithms;
};

/// Throws Error(input): no JSON, another format, a newer version, a key that is missing or of
/// another type, with its place.
ReportedReplay read_reported_replay(std::string_view text, const std::string& file);

/// "the recordings differ: A has …, B has …"; empty: the same scene.
std::vector<std::string> scene_differences(const ReportedReplay& a, const ReportedReplay& b);

struct ComparedAlgorithm {
  ReportedAlgorithm a, b;                                       ///< of one label
  std::optional<double> score_change, ns_change, bytes_change;  ///< B / A - 1
  std::optional<double> regret_change;                          ///< B - A
  std::optional<bool> resolved;  ///< the 95 % intervals are apart; none: an interval is not known
};

struct Comparison {
  ReportedReplay a, b;
  std::vector<std::string> differences;  ///< of the scenes
  std::vector<ComparedAlgorithm> both;   ///< that ran in both, in A's order
  /// Labels, with the reason where the other report gives one.
  std::vector<std::pair<std::string, std::string>> only_a, only_b;
};

Comparison compare_replays(const ReportedReplay& a, const ReportedReplay& b);

/// "[LABEL:]METRIC+LIMIT" with METRIC rmse, regret, ns_per_sample or peak_bytes, LIMIT "5%" or an
/// absolute number: B may exceed A by so much. For regret, 5% are five percentage points.
struct Check {
  std::string text, label, metric;
  double limit = 0;
  bool relative = false;
};
/// Throws Error(usage).
Check check_from_words(const std::string& text);

/// Sentences, one a breach: also for an algorithm that ran in A and not in B, and for a check that
/// finds nothing to compare.
std::vector<std::string> breaches(const Comparison& comparison, const Check& check);

/// {"format":"replay-comparison","version":1,…}
Json comparison_json(const Comparison& comparison, const std::vector<Check>& checks);
std::string comparison_markdown(const Comparison& comparison, const std::vector<Check>& checks);
/// Head and rows for a table, cells unescaped.
std::vector<std::vector<std::string>> comparison_table(const Comparison& comparison);

}  // namespace libchar
