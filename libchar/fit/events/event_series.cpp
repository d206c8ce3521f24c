// Means of m samples over what is present of them; a stretch without any is bridged by a straight line between its neighbours, and
// remembered: nobody can say where in it something happened. The number of means has no prime factor above 7, for the transforms'
// sake: at most one per cent of the record's end is not looked at.
#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/fit/events.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kFewest = 64;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

bool transforms_fast(std::uint64_t n) {
  for (const std::uint64_t prime : {2U, 3U, 5U, 7U})
    while (n % prime == 0) n /= prime;
  return n == 1;
}

void bridge(std::vector<double>& value, double step_s, std::vector<Interval>& unseen) {
  const std::size_t n = value.size();
  for (std::size_t t = 0; t < n; ++t) {
    if (!std::isnan(value[t])) continue;
    std::size_t end = t;
    while (end < n && std::isnan(value[end])) ++end;
    const double after = end < n ? value[end] : (t > 0 ? value[t - 1] : 0);
    const double before = t > 0 ? value[t - 1] : after;
    for (std::size_t i = t; i < end; ++i)
      value[i] = before + (after - before) * static_cast<double>(i - t + 1) /
                              static_cast<double>(end - t + 1);
    unseen.push_back({static_cast<double>(t) * step_s, static_cast<double>(end) * step_s});
    t = end;
  }
}

}  // namespace

EventSeries event_series(std::span<const double> record, double rate_hz, std::uint64_t points) {
  EventSeries series;
  const std::uint64_t most = std::max(points, kFewest);
  series.per_point = std::max<std::uint64_t>(1, (record.size() + most - 1) / most);
  series.step_s = static_cast<double>(series.per_point) / rate_hz;
  std::uint64_t n = record.size() / series.per_point;
  while (n > kFewest && !transforms_fast(n)) --n;
  if (n < kFewest)
    throw Error({ErrorKind::numeric,
                 "",
                 "",
                 "too few samples to look for steps and drifts",
                 std::to_string(record.size()) + " samples",
                 "use a record of at least 64 samples"});
  series.value.resize(n);
  for (std::uint64_t i = 0; i < n; ++i) {
    double sum = 0;
    std::uint64_t present = 0;
    const double shift = record[i * series.per_point];
    for (const double x : record.subspan(i * series.per_point, series.per_point)) {
      if (std::isnan(x)) continue;
      sum += std::isnan(shift) ? x : x - shift;
      ++present;
    }
    series.value[i] = present == 0
                          ? kMissing
                          : (std::isnan(shift) ? 0 : shift) + sum / static_cast<double>(present);
  }
  bridge(series.value, series.step_s, series.unseen_s);
  return series;
}

}  // namespace libchar
