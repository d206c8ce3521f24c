#include "libchar/replay/detail/tracks/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/not_known.hpp"

namespace libchar {
namespace {

bool still(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [&](double v) {
    return v == values[0] || (std::isnan(v) && std::isnan(values[0]));
  });
}

}  // namespace

Timeline thinned(std::span<const double> time_s,
                 const std::vector<std::vector<double>>& series,
                 std::size_t bins) {
  Timeline out;
  if (time_s.empty() || std::all_of(series.begin(), series.end(), still)) return out;
  bins = std::min(bins, time_s.size());
  out.low.resize(series.size());
  out.high.resize(series.size());
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t from = b * time_s.size() / bins, to = (b + 1) * time_s.size() / bins;
    out.time_s.push_back(0.5 * (time_s[from] + time_s[to - 1]));
    for (std::size_t s = 0; s < series.size(); ++s) {
      double low = kNone, high = kNone;
      for (std::size_t k = from; k < to; ++k) {
        // Written so that a number beats NaN.
        if (!(series[s][k] >= low)) low = std::isnan(series[s][k]) ? low : series[s][k];
        if (!(series[s][k] <= high)) high = std::isnan(series[s][k]) ? high : series[s][k];
      }
      out.low[s].push_back(low);
      out.high[s].push_back(high);
    }
  }
  return out;
}

Timeline window_rms(const ErrorMeter& meter, double rate_hz, double start_s, double window_s) {
  const std::vector<ErrorCell> cells = meter.cells();
  const double cell_s = static_cast<double>(meter.cell_samples()) / rate_hz;
  const auto half =
      static_cast<std::size_t>(std::max(0.0, std::round(window_s / cell_s / 2 - 0.5)));
  std::vector<double> times, rms;
  // Sums over each window of their own: a difference of running sums would keep the traces of a
  // large error for ever.
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::size_t from = c > half ? c - half : 0, to = std::min(cells.size(), c + half + 1);
    double sum = 0, n = 0;
    for (std::size_t k = from; k < to; ++k) {
      sum += cells[k].squares;
      n += cells[k].n;
    }
    times.push_back(start_s + (static_cast<double>(c) + 0.5) * cell_s);
    rms.push_back(n > 0 ? std::sqrt(sum / n) : kNone);
  }
  return thinned(times, {rms}, kWindowBins);
}

}  // namespace libchar
