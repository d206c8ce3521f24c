#pragma once
// The one door through which logs come in, whatever their format and however large they are.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

struct ReadOptions {
  /// Numbers that are not measurements.
  struct Missing {
    std::vector<double> marks;  ///< values that stand for "no reading" in the log: -999, 65535
    bool overflow = false;      ///< so does a number out of a double's range, instead of ending the reading
    bool bad_rows = false;      ///< rows that cannot be read are left out, of ten one at most (CSV)
  };

  /// What only the user knows of the log.
  struct Unsaid {
    std::string preset;              ///< which instrument wrote a .imu file: "IMAR", "LN200"…
    std::string msg;                 ///< folder of .msg files that define types of messages (ROS 2 before Iron)
    double rate_uncertainty_hz = 0;  ///< of `rate_hz`
    /// "gyro*=200Hz": rates of channels of a log without stamps, by name or pattern; the others have `rate_hz`
    std::vector<std::string> channel_rate;
  };

  /// Rows of several kinds in one table (CSV).
  struct Kinds {
    /// "sensor=Gyroscope": only rows with this in that column; all of them must hold
    std::vector<std::string> where;
    std::string group_by;     ///< a column whose values become channels of their own; "" = none
    bool own_stamps = false;  ///< each group keeps its stamps; else groups in turn share a row
  };

  std::vector<std::string>
      channels;  ///< names or c0, c1… to read, "!name" not to; empty = all. Unknown: Error(usage), the nearest
  std::string
      topic;  ///< of a log with several streams, the one to read; "" = the one that `channels` name, or the only one
  /// whose stamps, where messages have several: "auto", "header" (the sensor's), "log" (when recorded), "publish"
  std::string time_source = "auto";
  std::vector<std::string> names;  ///< new names of the channels read, in order; empty = as in the log
  std::vector<std::string> units;  ///< units of the channels read, in order, or one for all; empty = as in the log
  std::vector<std::string>
      channel_scale;  ///< "gx=1/16.4", "gyro*=0.05": factors of channels, by name or pattern; the last that fits wins
  std::vector<std::string> channel_unit;  ///< "gx=deg/s": units of channels, likewise
  Kinds kinds;
  Unsaid unsaid;
  std::string date_order = "auto";  ///< "auto", "day", "month", "year": which comes first in 05/01/24 (CSV)
  std::optional<double> from_s;     ///< first instant to use, seconds after the first stamp
  std::optional<double> to_s;       ///< first instant not to use
  std::optional<double>
      rate_hz;  ///< sampling rate; needed when the log has neither stamps nor a rate; wins over stamps' absence only
  std::string time_column = "auto";  ///< "auto", "none", a name, or c0-style position among all columns
  std::string time_unit = "auto";    ///< "auto", "s", "ms", "us", "ns", "100us", "100ns", "min", "h", "d"
  std::string format = "auto";       ///< "auto" or a name of the table of formats
  std::string delimiter = "auto";    ///< "auto", ",", ";", "tab", "space", or one character
  std::string decimal = "auto";      ///< "auto", "point", "comma"
  std::string header = "auto";       ///< "auto", "yes", "no"
  std::string encoding = "auto";     ///< "auto", "utf-8", "latin1", "cp1252" (CSV header only)
  std::uint64_t skip_rows = 0;       ///< lines to skip before the header (CSV)
  Missing missing;
  bool skip_repeated_header = false;  ///< header lines inside the data (concatenated logs) are counted and skipped
  std::size_t block_bytes = std::size_t{1}
                            << 21U;  ///< bytes of file per block; results never depend on it (tests use 1…70000)
  int threads = 0;                   ///< 0 = all cores; results never depend on it
  bool hash = true;                  ///< compute LogInfo::sha256
};

/// `rows` grid points of every selected channel. Valid only during the call that delivers it.
struct SampleBlock {
  std::uint64_t first = 0;  ///< grid index of the first sample
  std::size_t rows = 0;
  std::vector<const double*> channels;  ///< one pointer per selected channel, `rows` doubles each, NaN = missing
};

/// Receives a log in order. `begin` sees channels and what is known so far (the rate may still be refined at the end).
struct BlockSink {
  virtual ~BlockSink() = default;
  virtual void begin(const LogInfo& so_far) = 0;
  virtual void block(const SampleBlock& samples) = 0;
};

/// Streams a log once through `sink` in constant memory. "-" reads standard input (CSV only).
/// Throws Error(input) with file, line and column (or byte); Error(usage) for options that do not fit the file.
LogInfo read_log(const std::string& path, const ReadOptions& options, BlockSink& sink,
                 Progress& progress = no_progress());

/// Chosen channels first … end - 1.
struct ChannelRange {
  std::size_t first = 0, end = SIZE_MAX;
  bool has(std::size_t channel) const { return first <= channel && channel < end; }
};

/// Rows first … end-1 of a log without stamps with rows at fixed places (.npy, raw binary),
/// a sample each; nothing before them is read. Of channels out of the range the sink gets no
/// samples of the log but any numbers; what has to be said of the log, and not of a channel, is
/// said with the first. `from_s` and `to_s` do not count, no digest is taken, and whether a channel
/// has any value is not asked. Throws Error(usage) where rows have no fixed places or stamps.
LogInfo read_rows(const std::string& path, const ReadOptions& options, std::uint64_t first, std::uint64_t end,
                  BlockSink& sink, ChannelRange channels = {});

/// "" or why rows of a log cannot be read from anywhere: "its rows have no fixed places (csv)". `log`: its head.
std::string why_no_rows(const LogInfo& log);

/// The code of the Error for a log of several topics without a choice.
inline constexpr std::string_view kTopicNotChosen = "E0427";

/// The rows of a log in its order, each with its stamp: nothing is ordered and nothing put on a grid.
struct StampedRows {
  LogInfo info;
  std::vector<std::vector<double>> samples;  ///< by channel
  std::vector<std::int64_t> time_ns;         ///< empty where the log has no stamps
};
StampedRows read_stamped_rows(const std::string& path, const ReadOptions& options, Progress& progress = no_progress());

/// File, format and topics of a log, without reading its samples; no topics for formats of one table.
LogInfo log_listing(const std::string& path, const ReadOptions& options);

/// Standard input, a named pipe, a device: what was read is gone, and only CSV is read from it
/// unless the format is given.
bool read_once(const std::string& path);

/// The same, whole, in memory.
Recording read_recording(const std::string& path, const ReadOptions& options = {}, Progress& progress = no_progress());

}  // namespace libchar
