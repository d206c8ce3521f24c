// nu P^ / P is chi-square with nu degrees of freedom, so with confidence c and equal tails
//   P in [nu P^ / chi2_{nu, (1+c)/2},  nu P^ / chi2_{nu, (1-c)/2}].

#include "libchar/spectrum/spectrum_interval.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/chi_square.hpp"

namespace libchar {

std::pair<double, double> interval_factors(double dof, double confidence) {
  if (!(dof > 0)) return {0, std::numeric_limits<double>::infinity()};
  const double tail = (1 - confidence) / 2;
  return {dof / chi_square_upper_quantile(tail, dof), dof / chi_square_quantile(tail, dof)};
}

std::pair<double, double> IntervalFactors::of(double dof) {
  const auto known = known_.find(dof);
  return known != known_.end()
             ? known->second
             : known_.emplace(dof, interval_factors(dof, confidence_)).first->second;
}

std::pair<double, double> IntervalFactors::interval(const Spectrum& spectrum, std::size_t i) {
  const auto [low, high] = of(spectrum.dof[i]);
  const bool root = spectrum.scaling == Scaling::lsd || spectrum.scaling == Scaling::ls;
  const double value = spectrum.value[i];
  if (root) return {value * std::sqrt(low), value * std::sqrt(high)};
  return {value * low, value * high};
}

std::vector<std::optional<Interval>> spectrum_intervals(const Spectrum& spectrum,
                                                        IntervalFactors& factors) {
  std::vector<std::optional<Interval>> out(spectrum.frequency_hz.size());
  for (std::size_t i = 0; i < std::min(out.size(), spectrum.dof.size()); ++i) {
    if (!(spectrum.dof[i] > 0)) continue;
    const auto [low, high] = factors.interval(spectrum, i);
    out[i] = Interval{low, high};
  }
  return out;
}

std::vector<std::optional<Interval>> spectrum_intervals(const Spectrum& spectrum,
                                                        double confidence) {
  IntervalFactors factors(confidence);
  return spectrum_intervals(spectrum, factors);
}

}  // namespace libchar
