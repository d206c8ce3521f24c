// y(t) = y_k + (t - t_k) / (t_{k+1} - t_k) (y_{k+1} - y_k),   t_k <= t < t_{k+1}
#include "libchar/replay/detail/align/resampled.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/replay/detail/align/reference_track.hpp"

namespace libchar {
namespace {

/// Stamps further apart than so many median steps have a gap between them.
constexpr double kLongestStep = 4;

struct Nothing final : BlockSink {
  void begin(const LogInfo&) override {}
  void block(const SampleBlock&) override {}
};

double median_step(const std::vector<double>& stamps) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < stamps.size(); ++k) steps.push_back(stamps[k] - stamps[k - 1]);
  return median_in_place(steps, Middle::upper);
}

// Rows in rising order of time, within the window that was asked for.
std::vector<std::size_t> rows_in_order(const std::vector<double>& stamps, const ReadOptions& reading, LogInfo& log) {
  std::vector<std::size_t> rows;
  double last = -std::numeric_limits<double>::infinity();
  const double zero = stamps.empty() ? 0 : stamps[0];
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (!(stamps[k] > last)) {
      log.warnings.add("stamp_not_rising", "rows whose stamp does not advance were left out",
                       fmt::format("row {}", k + 1));
      continue;
    }
    last = stamps[k];
    const double t = stamps[k] - zero;
    if (t >= reading.from_s.value_or(0) && t < reading.to_s.value_or(std::numeric_limits<double>::infinity()))
      rows.push_back(k);
  }
  return rows;
}

// Options of a second reading, of all channels in the order of the rows.
ReadOptions of_all_rows(ReadOptions reading) {
  reading.hash = false;
  reading.units.clear();
  reading.channels.clear();
  return reading;
}

// Whatever the stamps are: numbers, dates, or those of messages.
std::vector<double> seconds_since_first(const std::vector<std::int64_t>& time_ns) {
  std::vector<double> out;
  out.reserve(time_ns.size());
  for (const std::int64_t t : time_ns) out.push_back(static_cast<double>(t - time_ns[0]) / 1e9);
  return out;
}

/// One channel that is interpolated.
struct Column {
  const std::vector<double>* values;
  double period = 0;  ///< of an angle; 0: none
};

std::vector<Column> columns_of(const StampedRows& rows, const std::vector<std::string>& wanted,
                               std::size_t first_angle) {
  std::vector<Column> out;
  for (const std::string& name : wanted) {
    const std::size_t c = column_of(rows.info, name, rows.info.file, "recording");
    const bool angle = out.size() >= first_angle;
    out.push_back({&rows.samples[c], angle ? full_turn(rows.info.channels[c].unit) : 0});
  }
  return out;
}

// Values at i / rate of a column, through the rows `used` in which it has a sample, which stand at times `t`; missing
// within a gap and beyond its samples.
std::vector<double> at_rate(const Column& column, const std::vector<std::size_t>& used, const std::vector<double>& t,
                            std::size_t instants, double rate_hz) {
  std::vector<double> times, values;
  for (std::size_t k = 0; k < used.size(); ++k) {
    const double value = (*column.values)[used[k]];
    if (std::isnan(value)) continue;
    times.push_back(t[k]);
    values.push_back(value);
  }
  std::vector<double> out(instants, kMissing);
  if (times.size() < 2) return out;
  const double longest = kLongestStep * median_step(times);
  std::size_t k = 0;
  for (std::size_t i = 0; i < instants; ++i) {
    const double now = static_cast<double>(i) / rate_hz;
    if (now < times.front() || now > times.back()) continue;
    while (k + 2 < times.size() && times[k + 1] <= now) ++k;
    const double step = times[k + 1] - times[k];
    if (step > longest && now > times[k] && now < times[k + 1]) continue;
    const double share = (now - times[k]) / step;
    out[i] = share == 0 ? values[k] : between(values[k], values[k + 1], share, column.period);
  }
  return out;
}

}  // namespace

ResampledLog read_resampled(const std::string& path, const ReadOptions& reading, const std::vector<std::string>& wanted,
                            double rate_hz, std::size_t first_angle, Progress& progress) {
  if (!reading.names.empty())
    throw input_error("E0907", path)
        .says("recording: names and resample_hz do not go together")
        .hint("give each sensor its channel:");
  ReadOptions whole = reading;
  whole.from_s.reset();
  whole.to_s.reset();
  whole.kinds.own_stamps = true;
  Nothing nothing;
  ResampledLog out;
  out.log = read_log(path, whole, nothing, progress);
  if (out.log.time.column.empty())
    throw input_error("E0907", path)
        .says("recording.resample_hz: this log has no time stamps to go by")
        .hint("leave resample_hz out");
  const StampedRows rows = read_stamped_rows(path, of_all_rows(whole), progress);
  out.log.warnings = rows.info.warnings;
  out.log.warnings.remove("slow_channel");  // each has its own samples here
  const std::vector<double> stamps = seconds_since_first(rows.time_ns);
  const std::vector<std::size_t> used = rows_in_order(stamps, reading, out.log);
  if (used.size() < 2)
    throw input_error("E0907", path).says("recording.resample_hz: fewer than two rows with rising stamps");
  std::vector<double> t;
  t.reserve(used.size());
  for (const std::size_t k : used) t.push_back(stamps[k] - stamps[used[0]]);
  const auto instants = clamped_whole<std::size_t>(std::floor(t.back() * rate_hz)) + 1;
  for (const Column& column : columns_of(rows, wanted, first_angle))
    out.samples.push_back(at_rate(column, used, t, instants, rate_hz));
  out.log.time.rate_hz = rate_hz;
  out.log.samples = instants;
  return out;
}

}  // namespace libchar
