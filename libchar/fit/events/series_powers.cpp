// Means of m samples of flicker: the sampled spectrum 1/(2 sin(phi/2)) times the response of the mean, folded,
//   (1/m) sum_j [sin(a/2) / (m sin(phi_j/2))]^2 / (2 |sin(phi_j/2)|),  phi_j = (a + 2 pi j)/m,  a = pi k/n,
// beside it the exact lowest coefficients of flicker (dct_means.cpp); means of a walk are the walk less a white part,
// K^2 m dt (1/(4 sin^2(a/2)) - (1 - 1/m^2)/6).
#include "libchar/fit/events/series_powers.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/chi_square.hpp"
#include "libchar/fit/detail/bin_likelihood.hpp"
#include "libchar/fit/detail/dct_means.hpp"
#include "libchar/fit/detail/goodness.hpp"
#include "libchar/fit/detail/scoring.hpp"
#include "libchar/fit/events.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

using std::numbers::pi;

constexpr std::uint64_t kExact = 64;  ///< coefficients at which a function is called one by one
constexpr double kGrid = 1.0442737824274;  ///< sixteenth of an octave

/// Flicker of means over flicker of samples at the means' rate.
double flicker_of_means(double a, std::uint64_t m) {
  if (m == 1) return 1;
  const double width = static_cast<double>(m), sine = std::sin(a / 2);
  const auto reach = static_cast<int>(std::min<std::uint64_t>(m / 2, 16));
  double sum = 0;
  for (int j = -reach; j <= reach; ++j) {
    if (2 * j == static_cast<int>(m)) continue;  // the same as -m/2
    const double fold = std::abs(std::sin((a + 2 * pi * j) / (2 * width)));
    sum += 1 / (fold * fold * fold);
  }
  return sum * sine * sine * sine / (width * width * width);
}

/// Log bins as of the noise fit: single coefficients to 24, then eight an octave.
std::vector<std::size_t> bin_edges(std::size_t n) {
  std::vector<std::size_t> edge;
  for (std::size_t k = 0; k < n;
       k = std::max(k + 1, static_cast<std::size_t>(static_cast<double>(k) * 1.0905)))
    edge.push_back(k);
  edge.push_back(n);
  return edge;
}

double mean_of(std::span<const double> values, std::size_t from, std::size_t to) {
  double sum = 0;
  for (std::size_t k = from; k < to; ++k) sum += values[k];
  return sum / static_cast<double>(to - from);
}

}  // namespace

std::array<double, kTerms> mean_unit_powers(double k,
                                            std::uint64_t n,
                                            std::uint64_t m,
                                            double dt_s) {
  const double step = dt_s * static_cast<double>(m), width = static_cast<double>(m);
  std::array<double, kTerms> unit = dct_mean(k, n, step);
  unit[static_cast<std::size_t>(Term::flicker)] *=
      flicker_of_means(pi * k / static_cast<double>(n), m);
  unit[static_cast<std::size_t>(Term::walk)] -= step * (1 - 1 / (width * width)) / 6;
  return unit;
}

std::vector<double> at_every_k(std::uint64_t n, const std::function<double(double)>& power) {
  std::vector<double> all(n - 1);
  const std::uint64_t exact = std::min<std::uint64_t>(kExact, n - 1);
  for (std::uint64_t k = 1; k <= exact; ++k) all[k - 1] = power(static_cast<double>(k));
  double low = static_cast<double>(exact) + 0.5, at_low = power(low);
  for (std::uint64_t k = exact + 1; k < n;) {
    const double high = low * kGrid, at_high = power(std::min(high, static_cast<double>(n)));
    for (; k < n && static_cast<double>(k) <= high; ++k)
      all[k - 1] = at_low + (at_high - at_low) * (static_cast<double>(k) - low) / (high - low);
    low = high;
    at_low = at_high;
  }
  return all;
}

std::vector<LevelStretch> level_stretches(std::size_t coefficients) {
  constexpr std::size_t kFirst = 256, kFew = 64;
  std::vector<LevelStretch> stretches;
  for (std::size_t from = kFirst; from < coefficients;) {
    std::size_t to = std::min(coefficients, from + std::max(kFew, from / 6));
    if (coefficients - to < kFew) to = coefficients;
    stretches.push_back({from, to});
    from = to;
  }
  return stretches;
}

double deviance_of(std::span<const double> coefficients, std::span<const double> power) {
  // A free level l of n coefficients has -2 ln L = n ln l + sum ln E + n at l = mean of c^2 / E.
  double sum = 0;
  const std::vector<LevelStretch> stretches = level_stretches(power.size());
  const std::size_t first = stretches.empty() ? power.size() : stretches[0].from;
  for (std::size_t k = 0; k < first; ++k)
    sum += coefficients[k] * coefficients[k] / power[k] + std::log(power[k]);
  for (const auto& [from, to] : stretches) {
    double level = 0, product = 1;
    for (std::size_t k = from; k < to; ++k) {
      level += coefficients[k] * coefficients[k] / power[k];
      product *= power[k] / power[from];  // within a stretch powers differ little
      if (product > 1e-200 && product < 1e200) continue;
      sum += std::log(product);
      product = 1;
    }
    const double count = static_cast<double>(to - from);
    sum += std::log(product) + count * (std::log(power[from]) + std::log(level / count) + 1);
  }
  return sum;
}

void raise_to_measured(std::span<const double> coefficients, std::vector<double>& power) {
  for (const auto& [from, to] : level_stretches(power.size())) {
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += coefficients[k] * coefficients[k] / power[k];
    const double count = static_cast<double>(to - from), ratio = sum / count;
    if (ratio > 1 + 4 * std::sqrt(2 / count))
      for (std::size_t k = from; k < to; ++k) power[k] *= ratio;
  }
}

std::vector<double> mixture_powers(const Mixture& theta,
                                   std::uint64_t n,
                                   std::uint64_t per_point,
                                   double rate_hz,
                                   const std::function<double(double)>& shape) {
  const double hz_per_k = rate_hz / (2 * static_cast<double>(n * per_point));
  return at_every_k(n, [&](double k) {
    const std::array<double, kTerms> unit = mean_unit_powers(k, n, per_point, 1 / rate_hz);
    double power = 0;
    for (std::size_t i = 0; i < kTerms; ++i) power += theta[i] * unit[i];
    return shape ? power * shape(k * hz_per_k) : power;
  });
}

namespace {

/// Bins of a series for white noise, flicker and walk, slow ones first.
std::vector<PowerBin> bins_of(const EventSeries& series) {
  const std::uint64_t n = series.value.size();
  const double rate_hz = static_cast<double>(series.per_point) / series.step_s;
  Dct dct(n);
  const std::span<const double> c = dct.transform(series.value).subspan(1);
  std::array<std::vector<double>, kTerms> unit;
  for (const Term term : {Term::white, Term::flicker, Term::walk}) {
    Mixture one{};
    one[static_cast<std::size_t>(term)] = 1;
    unit[static_cast<std::size_t>(term)] = mixture_powers(one, n, series.per_point, rate_hz);
  }
  std::vector<double> square(c.size());
  for (std::size_t k = 0; k < c.size(); ++k) square[k] = c[k] * c[k];
  std::vector<PowerBin> bins;
  const std::vector<std::size_t> edge = bin_edges(c.size());
  for (std::size_t b = 0; b + 1 < edge.size(); ++b) {
    PowerBin bin;
    bin.energy = mean_of(square, edge[b], edge[b + 1]);
    bin.dof = static_cast<double>(edge[b + 1] - edge[b]);
    for (std::size_t i = 0; i < kTerms; ++i)
      if (!unit[i].empty()) bin.unit[i] = mean_of(unit[i], edge[b], edge[b + 1]);
    bins.push_back(bin);
  }
  return bins;
}

/// Does the mixture describe the bins?
bool describes(const std::vector<PowerBin>& bins, const Mixture& theta) {
  constexpr double kProbability = 1e-3;
  double chi2 = 0;
  for (const PowerBin& bin : bins) {
    double model = 0;
    for (std::size_t i = 0; i < kTerms; ++i) model += theta[i] * bin.unit[i];
    const double z = normal_deviate(bin.energy / model, bin.dof);
    chi2 += z * z;
  }
  return chi_square_tail(chi2, static_cast<double>(bins.size())) > kProbability;
}

}  // namespace

// From the slow end up: a filter's slope at the top has ten thousand coefficients and would bend the slow noise to its own use.
NoisePowers fitted_powers() {
  return [](const EventSeries& series) {
    constexpr std::size_t kFewestBins = 32, kHalfOctave = 4;
    std::vector<PowerBin> bins = bins_of(series);
    const TermSet terms = {true, true, true, false, false};
    ScoringResult fit = score(bin_problem(bins), terms);
    while (bins.size() >= kFewestBins + kHalfOctave && !describes(bins, fit.at.theta)) {
      bins.resize(bins.size() - kHalfOctave);
      fit = score(bin_problem(bins), terms);
    }
    return mixture_powers(fit.at.theta,
                          series.value.size(),
                          series.per_point,
                          static_cast<double>(series.per_point) / series.step_s);
  };
}

}  // namespace libchar
