// y(t) = y_k + (t - t_k) / (t_{k+1} - t_k) (y_{k+1} - y_k),   t_k <= t < t_{k+1}
#include "libchar/replay/detail/resampled.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/replay/detail/reference_track.hpp"

namespace libchar {
namespace {

/// Stamps further apart than so many median steps have a gap between them.
constexpr double kLongestStep = 4;

struct Nothing final : BlockSink {
  void begin(const LogInfo&) override {}
  void block(const SampleBlock&) override {}
};

double seconds(const std::string& unit) {
  return unit == "ms" ? 1e-3 : unit == "us" ? 1e-6 : unit == "ns" ? 1e-9 : 1;
}

std::size_t column_of(const LogInfo& log, const std::string& name) {
  for (std::size_t c = 0; c < log.channels.size(); ++c)
    if (log.channels[c].name == name) return c;
  throw Error({ErrorKind::input,
               "E0900",
               log.file,
               "the recording has no channel of this name",
               name,
               "inspect lists the channels"});
}

double median_step(const std::vector<double>& stamps) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < stamps.size(); ++k) steps.push_back(stamps[k] - stamps[k - 1]);
  std::nth_element(
      steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return steps[steps.size() / 2];
}

// Rows in rising order of time, within the window that was asked for.
std::vector<std::size_t> rows_in_order(const std::vector<double>& stamps,
                                       const ReadOptions& reading,
                                       LogInfo& log) {
  std::vector<std::size_t> rows;
  double last = -std::numeric_limits<double>::infinity();
  const double zero = stamps.empty() ? 0 : stamps[0];
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (!(stamps[k] > last)) {
      log.warnings.add("stamp_not_rising",
                       "rows whose stamp does not advance were left out",
                       fmt::format("row {}", k + 1));
      continue;
    }
    last = stamps[k];
    const double t = stamps[k] - zero;
    if (t >= reading.from_s.value_or(0) &&
        t < reading.to_s.value_or(std::numeric_limits<double>::infinity()))
      rows.push_back(k);
  }
  return rows;
}

}  // namespace

ResampledLog read_resampled(const std::string& path,
                            const ReadOptions& reading,
                            const std::vector<std::string>& wanted,
                            double rate_hz,
                            std::size_t first_angle,
                            Progress& progress) {
  if (!reading.names.empty())
    throw Error({ErrorKind::input,
                 "E0907",
                 path,
                 "recording: names and resample_hz do not go together",
                 "",
                 "say channel: beside each sensor"});
  ReadOptions first = reading;
  first.from_s.reset();
  first.to_s.reset();
  Nothing nothing;
  const LogInfo stamped = read_log(path, first, nothing, progress);
  if (stamped.time.column.empty())
    throw Error({ErrorKind::input,
                 "E0907",
                 path,
                 "recording.resample_hz: this log has no time stamps to go by",
                 "",
                 "leave resample_hz out"});
  // Read once more with the stamps as a channel like the others.
  ReadOptions plain = first;
  plain.time_column = "none";
  plain.rate_hz = 1;
  plain.hash = false;
  plain.units.clear();
  plain.channels.clear();
  const Recording rows = read_recording(path, plain, progress);
  ResampledLog out;
  out.log = stamped;
  const std::vector<double>& raw = rows.samples[column_of(rows.info, stamped.time.column)];
  std::vector<double> stamps;
  const double unit = seconds(stamped.time.unit);
  for (const double t : raw) stamps.push_back((t - raw[0]) * unit);
  out.log.warnings = rows.info.warnings;
  const std::vector<std::size_t> used = rows_in_order(stamps, reading, out.log);
  if (used.size() < 2)
    throw Error({ErrorKind::input,
                 "E0907",
                 path,
                 "recording.resample_hz: fewer than two rows with rising stamps",
                 "",
                 ""});
  std::vector<double> t;
  for (const std::size_t k : used) t.push_back(stamps[k] - stamps[used[0]]);
  const double longest = kLongestStep * median_step(t);
  const auto instants = static_cast<std::size_t>(std::floor(t.back() * rate_hz)) + 1;
  std::vector<std::size_t> columns;
  std::vector<double> periods;
  for (const std::string& name : wanted) {
    columns.push_back(column_of(rows.info, name));
    periods.push_back(
        columns.size() > first_angle ? full_turn(rows.info.channels[columns.back()].unit) : 0);
  }
  out.samples.assign(wanted.size(), std::vector<double>(instants, kMissing));
  std::size_t k = 0;
  for (std::size_t i = 0; i < instants; ++i) {
    const double now = static_cast<double>(i) / rate_hz;
    while (k + 2 < t.size() && t[k + 1] <= now) ++k;
    const double step = t[k + 1] - t[k];
    if (step > longest && now > t[k]) continue;
    const double share = (now - t[k]) / step;
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      const auto& y = rows.samples[columns[c]];
      const double a = y[used[k]], b = y[used[k + 1]];
      out.samples[c][i] = share == 0 ? a : between(a, b, share, periods[c]);
    }
  }
  out.log.time.rate_hz = rate_hz;
  out.log.samples = instants;
  return out;
}

}  // namespace libchar
