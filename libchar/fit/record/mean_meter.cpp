// Two means become that of both by their weights, m1 + (m2 - m1) n2 / (n1 + n2): an offset costs no digits.
#include "libchar/fit/record/mean_meter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libchar/core/numeric/present.hpp"

namespace libchar {

void MeanMeter::Mean::take(std::span<const double> samples) {
  const PresentMean mean = present_mean(samples);
  join({mean.mean, mean.count});
}

void MeanMeter::Mean::join(const Mean& later) {
  if (later.present == 0) return;
  present += later.present;
  value += (later.value - value) * static_cast<double>(later.present) / static_cast<double>(present);
}

void MeanMeter::push(std::span<const double> samples) { all_.push(samples); }

void MeanMeter::join(MeanMeter later) { all_.join(std::move(later.all_)); }

void MeanMeter::scale(double factor) {
  for (Mean& mean : all_.parts) mean.value *= factor;
  all_.open.value *= factor;
}

std::vector<double> MeanMeter::means() const {
  std::vector<double> out;
  out.reserve(all_.parts.size());
  for (const Mean& mean : all_.parts)
    out.push_back(mean.present > 0 ? mean.value : std::numeric_limits<double>::quiet_NaN());
  return out;
}

std::uint64_t MeanMeter::missing() const {
  std::uint64_t present = all_.open.present;
  for (const Mean& mean : all_.parts) present += mean.present;
  return samples() - present;
}

EventSeries MeanMeter::series(double rate_hz) const {
  EventSeries series = event_series(means(), rate_hz / static_cast<double>(all_.length), kMostKept);
  series.per_point *= all_.length;
  return series;
}

EventSeries MeanMeter::series(double rate_hz, const Interval& part_s) const {
  const std::vector<double> all = means();
  const double per_s = rate_hz / static_cast<double>(all_.length);
  const auto at = [&](double time_s) {
    return static_cast<std::size_t>(std::min(static_cast<double>(all.size()), std::round(time_s * per_s)));
  };
  const std::size_t first = at(part_s.low);
  EventSeries series = event_series(std::span(all).subspan(first, std::max(first, at(part_s.high)) - first), per_s);
  series.per_point *= all_.length;
  return series;
}

void MeanMeter::write_state(StateWriter& to) const { all_.write_state(to); }

void MeanMeter::read_state(StateReader& from) {
  all_.read_state(from, "the means of a channel");
  const auto too_many = [&](const Mean& mean) { return mean.present > all_.length; };
  if (std::any_of(all_.parts.begin(), all_.parts.end(), too_many) || all_.open.present > all_.filled)
    from.refuse("the means of a channel");
}

}  // namespace libchar
