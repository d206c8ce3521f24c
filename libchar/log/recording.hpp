#pragma once
// What a log holds, once read: named channels on a uniform grid of samples, and what had to be repaired to get there.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// NaN inside a sample block means: this sample is missing. Nowhere else does NaN mean anything.
inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

struct Channel {
  std::string name;         ///< never empty; "c0", "c1"… when the log has no names (c0 is the first non-time column)
  std::string unit;         ///< as written in the log, "" when it says nothing
  bool integer = false;     ///< every value is an integer written as one (counts)
  double every = 1;         ///< rows for one of its values, where it has a clock of its own in a table of others
  double rate_hz = 0;       ///< of its own, where it was read on a grid of its own; 0: that of the log
  std::string stated = {};  ///< unit that the log says
  std::string own_clock = {};  ///< column with its stamps, where they are not those of the table
  double factor = 1;           ///< that the numbers of the log were multiplied with
};

/// One stream of messages, or one table, of a log that holds several: each has a clock of its own.
struct LogTopic {
  std::string name;             ///< "/imu0", "sensor_gyro_fifo 0", "run1/gyro"
  std::string type;             ///< "sensor_msgs/msg/Imu"; "" when the log says none
  std::uint64_t rows = 0;       ///< messages or rows, as far as the log says without being read whole
  double rate_hz = 0;           ///< rows over their time, roughly; 0 when not known
  std::vector<Channel> fields;  ///< the numbers of a row, among which channels are chosen
  bool sensor = false;          ///< of a type that sensors write: taken when it is the only one
  std::string why_not;          ///< why no field can be read ("images", "encoding protobuf"); "" when they can
};

/// The time axis: sample k of the grid is at t0 + k / rate.
struct TimeBase {
  double rate_hz = 0;         ///< 0 when unknown (no stamps and no `rate_hz`)
  bool from_stamps = false;   ///< rate found by robust slope of the stamps; else given by the user or the file
  std::string column;         ///< name of the time column, "" when there is none
  std::string candidate;      ///< without one: a channel that `time_column` could name, as it rises
  std::string unit;           ///< "s", "ms", "us", "ns", "min", "h", "100000 ns"…, "" when there is none
  std::int64_t unit_ns = 0;   ///< the same in nanoseconds; 0 when there is none
  bool unit_guessed = false;  ///< the unit was inferred from the magnitude of the stamps, not read
  bool local = false;         ///< dates without a zone: an hour may be repeated or missing
  std::optional<std::int64_t> start_ns;  ///< stamp of the first sample in ns, when the log has stamps
  double jitter_s = 0;                   ///< robust standard deviation (1.483 MAD) of stamp minus grid
  double max_deviation_s = 0;            ///< largest |stamp minus grid|
  std::uint64_t gaps = 0;                ///< stretches of missing grid points
  std::uint64_t missing_samples = 0;     ///< grid points without a row
};

/// Everything about a log but its samples.
struct LogInfo {
  std::string file;
  std::string format;  ///< as in the table of formats: "csv", "npy", "raw"…
  std::string sha256;  ///< of the whole file; "" when only part of a pipe was read
  std::uint64_t bytes = 0;
  std::uint64_t rows =
      0;  ///< data rows in the file; before its end as the first ones let expect, 0 when there is no telling
  std::uint64_t rows_used = 0;  ///< of these, on the grid: rows = used + dropped + outside
  std::uint64_t rows_dropped =
      0;  ///< with a warning that says why (duplicate_timestamp, backward_timestamp, wild_stamp, own_rows)
  std::uint64_t rows_outside = 0;  ///< before `from_s` or from `to_s` on
  std::uint64_t samples = 0;       ///< grid points delivered (rows used + missing)
  std::uint64_t first_line = 0;    ///< CSV: physical line of the first data row; 0 for other formats
  std::vector<Channel> channels;
  std::vector<LogTopic> topics;  ///< of a log that holds several streams; empty for one table
  std::string topic;             ///< the one that was read; "" when there are none
  TimeBase time;
  /// what was used of the log, in seconds after its first stamp, where that is not all of it
  std::optional<Interval> stretch_s;
  Findings warnings;  ///< every repair, counted by kind with its first places
  std::vector<std::string>
      guesses;  ///< what was inferred and not read, in sentences ("time unit: us, from the magnitude of the stamps")
  std::vector<std::string>
      dialect;  ///< what was understood of the file ("delimiter ;", "decimal comma", "header in line 3")

  double rate_hz_of(const Channel& channel) const { return channel.rate_hz > 0 ? channel.rate_hz : time.rate_hz; }
};

/// A whole recording in memory, each channel contiguous.
struct Recording {
  LogInfo info;
  std::vector<std::vector<double>> samples;  ///< samples[channel][grid point]
  std::span<const double> channel(std::size_t index) const { return samples[index]; }
};

// A recording whose samples belong to somebody else: columns of a table in memory, arrays of another language.

/// The samples must live as long as it is used. A caller who makes one names `info.channels` and
/// `info.time.rate_hz` and leaves the rest as it is.
struct RecordingView {
  LogInfo info;
  std::vector<std::span<const double>> samples;  ///< samples[channel]; NaN is missing
};

inline RecordingView view_of(const Recording& recording) {
  return {recording.info, {recording.samples.begin(), recording.samples.end()}};
}
RecordingView view_of(Recording&&) = delete;

}  // namespace libchar
