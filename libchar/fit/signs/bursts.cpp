// Linear functions of Gaussian noise of any colour are Gaussian: the differences d of neighbouring means of m samples
// have the kurtosis n sum d^4 / (sum d^2)^2 = 3, and their standard deviation is 1.4826 median |d|. Bursts of disturbed
// samples, shorter or longer than m, are a few of the d, far beyond the others: as a share of the spectrum they are a
// low-pass of white noise, which no likelihood of powers tells from noise. The median is that of the quiet differences
// (F. R. Hampel, J. Am. Stat. Assoc. 69 (1974) 383).
#include "libchar/fit/signs/bursts.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar::detail {
namespace {

constexpr std::size_t kFewestDifferences = 256;
constexpr double kOfMedian = 1.4826;  ///< a Gaussian's standard deviation over its median distance
constexpr double kMostEqual = 0.4;    ///< share of differences that are zero: steps of a converter of 2 sd

/// The series less the events; NaN where it was not seen.
std::vector<double> seen_values(const EventSeries& series, std::span<const Event> events) {
  const double rate_hz = static_cast<double>(series.per_point) / series.step_s;
  std::vector<double> out = series.value;
  for (std::size_t i = 0; i < out.size() && !events.empty(); ++i)
    out[i] -= event_mean(events, rate_hz, series.start_s * rate_hz + static_cast<double>(i * series.per_point),
                         static_cast<double>(series.per_point));
  const auto point_at = [&](double at_s) {
    const double point = (at_s - series.start_s) / series.step_s;
    return clamped_whole<std::size_t>(std::clamp(point, 0.0, static_cast<double>(out.size())));
  };
  for (const Interval& gap : series.unseen_s) {
    const auto from = static_cast<std::ptrdiff_t>(point_at(gap.low));
    const auto to = static_cast<std::ptrdiff_t>(point_at(std::max(gap.low, gap.high) + series.step_s));
    std::fill(out.begin() + from, out.begin() + to, std::nan(""));
  }
  return out;
}

std::vector<double> differences_of_means(std::span<const double> value, std::size_t scale) {
  std::vector<double> out;
  double before = std::nan("");
  for (std::size_t i = 0; i + scale <= value.size(); i += scale) {
    double mean = 0;
    for (std::size_t j = i; j < i + scale; ++j) mean += value[j] / static_cast<double>(scale);
    if (std::isfinite(mean - before)) out.push_back(mean - before);
    before = mean;
  }
  return out;
}

/// sum over all lags of rho^4: the variance of a kurtosis is 24/n times that (J. W. Lomnicki, Metrika 4 (1961) 37).
double spread_by_colour(const std::vector<double>& d, double squares) {
  constexpr std::size_t kLags = 64;
  double sum = 1;
  for (std::size_t lag = 1; lag <= std::min(kLags, d.size() / 4); ++lag) {
    double product = 0;
    for (std::size_t i = lag; i < d.size(); ++i) product += d[i] * d[i - lag];
    sum += 2 * std::pow(product / squares, 4);
  }
  return sum;
}

bool is_coarse(std::span<const double> d) {
  return static_cast<double>(std::count(d.begin(), d.end(), 0.0)) > kMostEqual * static_cast<double>(d.size());
}

/// Of one scale; none where they are Gaussian.
std::optional<Bursts> bursts_among(std::vector<double> d) {
  constexpr double kDeviations = 5;
  const auto n = static_cast<double>(d.size());
  double squares = 0, fourths = 0;
  for (const double one : d) {
    squares += one * one;
    fourths += std::pow(one, 4);
  }
  if (!(squares > 0)) return std::nullopt;
  Bursts out;
  out.kurtosis = n * fourths / (squares * squares);
  if (!(out.kurtosis > spike_alarm(d.size()))) return std::nullopt;
  if (!(out.kurtosis > 3 + kDeviations * std::sqrt(24 / n * spread_by_colour(d, squares)))) return std::nullopt;
  for (double& one : d) one = std::abs(one);
  out.core = kOfMedian * median_in_place(d) / std::sqrt(squares / n);
  return out;
}

}  // namespace

std::optional<Bursts> find_bursts(const EventSeries& series, std::span<const Event> events) {
  std::optional<Bursts> strongest;
  const std::vector<double> value = seen_values(series, events);
  for (std::size_t scale = 1; scale <= 8; scale *= 2) {
    std::vector<double> d = differences_of_means(value, scale);
    if (d.size() < kFewestDifferences || (scale == 1 && is_coarse(d))) break;
    std::optional<Bursts> here = bursts_among(std::move(d));
    if (!here || !(here->core < (strongest ? strongest->core : 1))) continue;
    here->tau_s = static_cast<double>(scale) * series.step_s;
    strongest = here;
  }
  return strongest;
}

}  // namespace libchar::detail
