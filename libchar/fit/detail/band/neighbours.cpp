// An interval within one shape does not know that the shape was chosen. Where s has m unknowns more than needed and s'
// is nested in it, theta(s) - theta(s') has the variance var(s) - var(s') (J. A. Hausman, Econometrica 46 (1978) 1251):
// the shift is about a standard deviation where the poorer shape is right, and is its bias where it is not. So each
// interval is joined with itself as shifted to the richer shapes:
//   low = min over s of low exp(min(0, d_s)),  high = max over s of high exp(max(0, d_s)),  d_s = ln of the shift.
// Neighbours: a polynomial with one and two orders more; of a filter or loop those with one root more, where they are
// as likely.
#include "libchar/fit/detail/band/neighbours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {
namespace {

using Family = NamedShape::Family;

std::vector<Band> richer_polynomials(const Band& band) {
  constexpr int kMore = 2;
  const int most = kMostShape - static_cast<int>(unknowns_of(band.resonances));
  std::vector<Band> out;
  for (int orders = band.orders + 1; orders <= std::min(most, band.orders + kMore); ++orders) {
    out.push_back(band);
    out.back().orders = orders;
  }
  return out;
}

std::vector<Family> richer(Family family) {
  if (family == Family::second_order) return {Family::third_order, Family::loop};
  if (family == Family::third_order || family == Family::shelf) return {Family::loop};
  return {};
}

std::vector<Band> richer_roots(const std::vector<PowerBin>& bins, const Band& band, const TermSet& terms,
                               double rate_hz) {
  Band plain = band;
  plain.named = {};
  plain.orders = 0;
  const std::vector<PowerBin> inside = bins_of(bins, plain, rate_hz);
  std::vector<Band> out;
  for (const Family family : richer(band.named.family)) {
    const auto start = family == Family::third_order ? std::optional(band.named) : std::nullopt;
    const auto shape = fit_named_shape(inside, rate_hz, terms, family, start);
    if (!shape) continue;
    plain.named = *shape;
    plain.orders = static_cast<int>(unknowns_of(family));
    out.push_back(plain);
  }
  return out;
}

void reach_by(double shift, Coefficient& term) {
  term.ci95.low *= std::exp(std::min(0.0, shift));
  term.ci95.high *= std::exp(std::max(0.0, shift));
}

}  // namespace

void reach_to_neighbours(const std::vector<PowerBin>& bins, const Band& band, NoiseFit& fit) {
  constexpr double kAsLikely = 0.5;  ///< of ln L
  const bool named = band.named.family != Family::none;
  if (band.orders == 0 || band.named.family == Family::high_pass) return;
  const TermSet terms = only_positive(fit.theta);
  const double chosen = score(band_problem(bins, band, fit.rate_hz), terms).half_deviance;
  std::array<double, kTerms> least{}, most{};
  for (const Band& other : named ? richer_roots(bins, band, terms, fit.rate_hz) : richer_polynomials(band)) {
    const ScoringResult there = score(band_problem(bins, other, fit.rate_hz), terms);
    if (!(there.half_deviance < chosen + kAsLikely)) continue;
    for (std::size_t i = 0; i < kTerms; ++i) {
      if (!(fit.theta[i] > 0) || !(there.at.theta[i] > 0)) continue;
      const double shift = 0.5 * std::log(there.at.theta[i] / fit.theta[i]);
      least[i] = std::min(least[i], shift);
      most[i] = std::max(most[i], shift);
    }
  }
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!fit.term[i].value) continue;
    reach_by(least[i], fit.term[i]);
    reach_by(most[i], fit.term[i]);
  }
}

}  // namespace libchar
