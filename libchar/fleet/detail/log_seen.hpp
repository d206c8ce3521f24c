#pragma once
// Which file a result was computed from, where its digest does not say so by itself. A digest that
// was stated is a claim until a worker has found it to be that of the log; and a stretch, which is
// a part of a log, cannot check the digest of the whole. Such results hold beside them what the log
// was when it was read, its path, size and time of change (log.seen), and count for a unit only as
// long as its log is still that. Times are compared for being the same, never for being earlier.

#include <filesystem>
#include <optional>
#include <string>

#include "libchar/fleet/unit.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

/// SHA-256 of the whole file, 64 hexadecimal digits. Throws Error(input).
std::string digest_of_log(const std::string& path);

/// As the file stands now: path, size and time of change. Nothing where it cannot be looked at.
std::optional<std::string> log_as_seen(const std::string& log);

/// Whether results of the unit need it.
bool needs_log_seen(const FleetUnit& unit);

/// Into the folder of a result, which may be published already. Throws Error(output).
void write_log_seen(const std::filesystem::path& folder, const std::string& seen);

/// Whether the result `id` was computed from, or its digest found in, this log as it stands; where
/// the log cannot be looked at (a merge on another machine), whether it has its path.
bool is_log_seen(const std::filesystem::path& fleet, const std::string& id, const std::string& log);

/// Whether a result that is there counts for this unit.
bool result_counts(const std::filesystem::path& fleet, const FleetUnit& unit);

/// Absolute and without "..", so that one log has one name; `named` is relative to `folder`. "" stays "".
std::string absolute_path(const std::string& named, const std::filesystem::path& folder);

/// Of a manifest or a file of digests: what the paths in it are relative to.
std::filesystem::path folder_of_file(const std::string& path);

// What a unit is expected to take, from measurements of this machine:
//   seconds = fixed * channels + sample * samples * channels + byte * bytes of text
// `fixed` and `sample` from characterizing two simulated records in memory, `byte` from reading a simulated CSV file.

struct CostModel {
  double fixed_s = 0;        ///< a channel's fit and its part of the report
  double sample_s = 0;       ///< a sample's curve and spectrum
  double text_byte_s = 0;    ///< reading and hashing a byte of a text log
  double binary_byte_s = 0;  ///< the same of a binary log

  UnitCost of(const FleetUnit& unit, const LogInfo& head) const;
};

/// Measures, about a second.
CostModel measured_cost();

}  // namespace libchar
