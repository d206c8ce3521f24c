// Windows as sums of cosines: w_j = a0 - a1 cos(x) + a2 cos(2x) - a3 cos(3x) + a4 cos(4x), x = 2 pi j / n (periodic).
// Hann: the usual; Blackman-Harris: F. J. Harris, Proc. IEEE 66, 1978, minimum 4-term; flat top: G. D'Antona and A.
// Ferrero, Digital Signal Processing for Measurement Systems, 2006 (the five terms used by MATLAB and SciPy).

#include "libchar/spectrum/spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/numeric/distributions.hpp"

namespace libchar {
namespace {

struct Row {
  Window window;
  std::array<double, 5> terms;
};

constexpr std::array<Row, 5> kWindows = {{
    {Window::hann, {0.5, 0.5}},
    {Window::rectangular, {1}},
    {Window::blackman_harris, {0.35875, 0.48829, 0.14128, 0.01168}},
    {Window::flat_top, {0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368}},
    {Window::hann_nonzero, {0.5, 0.5}},
}};

const Row& row_of(Window window) {
  for (const Row& row : kWindows)
    if (row.window == window) return row;
  return kWindows[0];
}

}  // namespace

std::vector<double> window_values(Window window, std::size_t n) {
  const std::array<double, 5>& terms = row_of(window).terms;
  const bool symmetric = window == Window::hann_nonzero;
  const std::size_t period = symmetric ? n + 1 : n, first = symmetric ? 1 : 0;
  std::vector<double> w(n);
  for (std::size_t j = 0; j < n; ++j) {
    // Folded to the first half of the period: symmetric to the last bit, and half the cosines.
    const std::size_t position = j + first, mirror = period - position;
    if (mirror < position) {
      w[j] = w[mirror - first];
      continue;
    }
    const double x = 2 * std::numbers::pi * static_cast<double>(position) / static_cast<double>(period);
    double value = terms[0], sign = -1;
    for (std::size_t m = 1; m < terms.size() && terms[m] != 0; ++m, sign = -sign)
      value += sign * terms[m] * std::cos(static_cast<double>(m) * x);
    w[j] = value;
  }
  return w;
}

// nu P^ / P is chi-square with nu degrees of freedom, so with confidence c and equal tails
//   P in [nu P^ / chi2_{nu, (1+c)/2},  nu P^ / chi2_{nu, (1-c)/2}].

std::pair<double, double> interval_factors(double dof, double confidence) {
  if (!(dof > 0)) return {0, std::numeric_limits<double>::infinity()};
  const double tail = (1 - confidence) / 2;
  return {dof / chi_square_upper_quantile(tail, dof), dof / chi_square_quantile(tail, dof)};
}

std::pair<double, double> IntervalFactors::of(double dof) {
  const auto known = known_.find(dof);
  return known != known_.end() ? known->second : known_.emplace(dof, interval_factors(dof, confidence_)).first->second;
}

std::pair<double, double> IntervalFactors::interval(const Spectrum& spectrum, std::size_t i) {
  const auto [low, high] = of(spectrum.dof[i]);
  const bool root = spectrum.scaling == Scaling::lsd || spectrum.scaling == Scaling::ls;
  const double value = spectrum.value[i];
  if (root) return {value * std::sqrt(low), value * std::sqrt(high)};
  return {value * low, value * high};
}

std::vector<std::optional<Interval>> spectrum_intervals(const Spectrum& spectrum, IntervalFactors& factors) {
  std::vector<std::optional<Interval>> out(spectrum.frequency_hz.size());
  for (std::size_t i = 0; i < std::min(out.size(), spectrum.dof.size()); ++i) {
    if (!(spectrum.dof[i] > 0)) continue;
    const auto [low, high] = factors.interval(spectrum, i);
    out[i] = Interval{low, high};
  }
  return out;
}

std::vector<std::optional<Interval>> spectrum_intervals(const Spectrum& spectrum, double confidence) {
  IntervalFactors factors(confidence);
  return spectrum_intervals(spectrum, factors);
}

}  // namespace libchar
