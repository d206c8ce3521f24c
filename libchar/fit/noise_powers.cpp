#include "libchar/fit/noise_powers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "libchar/core/chi_square.hpp"
#include "libchar/fit/detail/bin_likelihood.hpp"
#include "libchar/fit/detail/goodness.hpp"
#include "libchar/fit/detail/scoring.hpp"
#include "libchar/fit/events/series_powers.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {

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
