// y_ij = b_i + c_i (T_ij - T_ref) + r_ij + e_ij: bias of recording j of device i, c_i its
// temperature coefficient, r what the bias differs by whenever the device is switched on, with one
// spread for all devices of the group, e the noise. A line a device, the spread pooled over all:
// detail/grouped_lines.cpp. The interval of a slope is by Student's t with the degrees of freedom
// of the pooled spread. Bias at several constant temperatures and its slope by least squares is the
// usual test of a gyroscope (IEEE Std 952, temperature sensitivity).
#include "libchar/lot/detail/statistics/temperature_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/distributions.hpp"

namespace libchar {
namespace {

constexpr Interval kNothing = {std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity()};

void widen(Interval& range, double value) {
  if (std::isnan(value)) return;
  range = {std::min(range.low, value), std::max(range.high, value)};
}

/// Temperatures of each member that counts.
std::vector<Interval> temperature_ranges(const MemberRecordings& in) {
  std::vector<Interval> out(in.members.size(), kNothing);
  for (std::size_t i = 0; i < in.y.size(); ++i) widen(out[in.member[i]], in.temperature_c[i]);
  return out;
}

/// A member with a line has no use for a recording of which the temperature is not known.
MemberRecordings of_known_temperature(const MemberRecordings& in, const std::vector<bool>& sloped) {
  MemberRecordings out;
  out.members = in.members;
  out.counts = in.counts;
  out.batch_counts = in.batch_counts;
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    if (sloped[in.member[i]] && std::isnan(in.temperature_c[i])) continue;
    out.y.push_back(in.y[i]);
    out.v.push_back(in.v[i]);
    out.temperature_c.push_back(in.temperature_c[i]);
    out.place.push_back(in.place[i]);
    out.member.push_back(in.member[i]);
  }
  return out;
}

/// The lower one of two: a temperature at which something was recorded.
double median_temperature(const MemberRecordings& in) {
  std::vector<double> known;
  for (const double t : in.temperature_c)
    if (!std::isnan(t)) known.push_back(t);
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>((known.size() - 1) / 2);
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

TemperatureRuns runs_of(const MemberRecordings& in,
                        const std::vector<Interval>& ranges,
                        const std::vector<bool>& sloped) {
  TemperatureRuns out;
  out.range_c = kNothing;
  out.reference_c = median_temperature(in);
  for (std::size_t i = 0; i < in.y.size(); ++i) out.recordings += sloped[in.member[i]];
  for (std::size_t m = 0; m < sloped.size(); ++m) {
    const Interval& at = ranges[m];
    if (sloped[m]) {
      ++out.devices;
      widen(out.range_c, at.low);
      widen(out.range_c, at.high);
    } else if (at.low <= at.high) {
      out.elsewhere += at.low - out.reference_c >= kLeastTemperatureSpan ||
                       out.reference_c - at.high >= kLeastTemperatureSpan;
    }
  }
  return out;
}

}  // namespace

std::optional<TemperatureLines> temperature_lines(const MemberRecordings& biases) {
  const std::vector<Interval> ranges = temperature_ranges(biases);
  std::vector<bool> sloped(ranges.size());
  for (std::size_t m = 0; m < ranges.size(); ++m)
    sloped[m] = ranges[m].high - ranges[m].low >= kLeastTemperatureSpan;
  if (std::find(sloped.begin(), sloped.end(), true) == sloped.end()) return std::nullopt;
  TemperatureLines out;
  out.recordings = of_known_temperature(biases, sloped);
  out.runs = runs_of(out.recordings, ranges, sloped);
  std::vector<double> x = out.recordings.temperature_c;
  for (double& t : x) t -= out.runs.reference_c;
  out.lines = grouped_lines(out.recordings.y, out.recordings.v, x, out.recordings.member, sloped);
  out.sloped = std::move(sloped);
  out.runs.repeatability = out.lines.within;
  out.runs.repeatability_ci95 = out.lines.within_ci95;
  out.runs.dof = out.lines.dof;
  return out;
}

std::vector<DeviceSlope> device_slopes(const TemperatureLines& at) {
  if (at.lines.dof < 1) return {};
  std::vector<DeviceSlope> out;
  const double t = student_quantile(0.975, at.lines.dof);
  const MemberRecordings& in = at.recordings;
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    const std::size_t m = in.member[i];
    if (!at.sloped[m]) continue;
    if (i == 0 || in.member[i - 1] != m) {
      const double slope = at.lines.slope[m], half = t * std::sqrt(at.lines.slope_variance[m]);
      out.push_back({in.place[i].recording,
                     in.place[i].channel,
                     0,
                     kNothing,
                     slope,
                     {slope - half, slope + half}});
    }
    ++out.back().recordings;
    widen(out.back().temperature_c, in.temperature_c[i]);
  }
  return out;
}

}  // namespace libchar
