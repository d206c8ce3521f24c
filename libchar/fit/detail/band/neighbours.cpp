// An interval within one shape does not know that the shape was chosen. Where s has m unknowns more than needed and s'
// is nested in it, theta(s) - theta(s') has the variance var(s) - var(s') (J. A. Hausman, Econometrica 46 (1978) 1251):
// the shift is about a standard deviation where the poorer shape is right, and is its bias where it is not. So each
// interval is joined with itself as shifted to the richer shapes,
//   low = min over s of low exp(min(0, d_s)),  high = max over s of high exp(max(0, d_s)),  d_s = ln of the shift,
// and with that of the average over the shapes, L: sum_s w_s Phi((L - m_s) / sd_s) = .025, and likewise above, with
// m = ln theta / 2 and Akaike's weights (D. Turek, D. Fletcher, Comput. Stat. Data Anal. 56 (2012) 2809): a shift is
// known no better than the richer shape.
// Neighbours: of the terms alone a step of the level (a shelf), where its score is clear; of a polynomial one and two
// orders more, and from three on the filters with corners; of a filter of equal weights one to four orders; of a filter
// with corners those with one root more, and itself in half an octave and in an octave less of the band, for what bends
// its flank is another shape's. A shift counts where they are as likely, that of a step by its weight alone.
#include "libchar/fit/detail/band/neighbours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"
#include "libchar/fit/detail/curve/profile.hpp"

namespace libchar {
namespace {

using Family = NamedShape::Family;

std::vector<Band> richer_polynomials(const Band& band) {
  const int more = band.filter.kind == NoiseShape::Kind::none ? 2 : 4;
  const int most = kMostShape - static_cast<int>(unknowns_of(band.resonances));
  std::vector<Band> out;
  for (int orders = band.orders + 1; orders <= std::min(most, band.orders + more); ++orders) {
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

std::vector<Band> with_roots(const std::vector<PowerBin>& bins, const Band& band, const TermSet& terms,
                             const std::vector<Family>& families, double rate_hz) {
  Band plain = band;
  plain.named = {};
  plain.orders = 0;
  const std::vector<PowerBin> inside = bins_of(bins, plain, rate_hz);
  std::vector<Band> out;
  std::optional<NamedShape> second;
  if (band.named.family == Family::second_order) second = band.named;
  for (const Family family : families) {
    if (family == Family::third_order && !second) continue;
    const auto shape =
        fit_named_shape(inside, rate_hz, terms, family, family == Family::third_order ? second : std::nullopt);
    if (!shape) continue;
    if (family == Family::second_order) second = shape;
    plain.named = *shape;
    plain.orders = static_cast<int>(unknowns_of(family));
    out.push_back(plain);
  }
  return out;
}

bool is_plain(const Band& band) {
  return band.orders == 0 && !band.low_pass && band.filter.kind == NoiseShape::Kind::none &&
         band.named.family == Family::none && band.resonances.empty();
}

/// What is white above a low corner may have another level below it, and slow terms make up for it; a walk may be
/// level, or a flicker lower, behind a high-pass.
std::vector<Band> with_hidden(const std::vector<PowerBin>& bins, const Band& band, const TermSet& kept,
                              const TermSet& offered, double rate_hz) {
  std::vector<Band> out;
  if (band.tau_s) return out;  // a process has the spectrum of a step
  for (const NamedShape& hidden : band.hidden) {
    const TermSet& terms = hidden.family == Family::high_pass ? offered : kept;
    const auto shape = fit_named_shape(bins_of(bins, band, rate_hz), rate_hz, terms, hidden.family, hidden);
    if (!shape) continue;
    out.push_back(band);
    out.back().named = *shape;
    out.back().orders = static_cast<int>(unknowns_of(shape->family));
  }
  return out;
}

/// Where a directed test sees more than one pole.
std::vector<Band> beside_low_pass(const std::vector<PowerBin>& bins, const Band& band, const TermSet& kept,
                                  double rate_hz) {
  if (band.hidden.empty()) return {};
  Band plain = band;
  plain.low_pass.reset();
  plain.small = {};
  return with_roots(bins, plain, kept, {Family::shelf, Family::second_order, Family::loop}, rate_hz);
}

std::vector<Band> neighbours_of(const std::vector<PowerBin>& bins, const Band& band, const TermSet& kept,
                                const TermSet& offered, double rate_hz) {
  if (is_plain(band)) return with_hidden(bins, band, kept, offered, rate_hz);
  if (band.low_pass && band.orders == 0) return beside_low_pass(bins, band, kept, rate_hz);
  if (band.orders == 0 && band.filter.kind == NoiseShape::Kind::none) return {};
  if (band.named.family != Family::none) return with_roots(bins, band, kept, richer(band.named.family), rate_hz);
  std::vector<Band> out = richer_polynomials(band);
  if (band.orders < kMany || !band.resonances.empty()) return out;
  const std::vector<Family> corners = {Family::shelf, Family::second_order, Family::third_order, Family::loop};
  for (Band& other : with_roots(bins, band, kept, corners, rate_hz)) out.push_back(std::move(other));
  return out;
}

/// What a shape says of a term: ln of the coefficient and its standard deviations below and above.
struct Opinion {
  double weight = 0, mean = 0, below = 0, above = 0;
};

/// Where the average over the opinions has less than 2.5 % beyond: below them for a side of -1, above for 1.
double end_of(const std::vector<Opinion>& opinions, int side) {
  constexpr int kHalvings = 40;
  double sum = 0, inner = std::numeric_limits<double>::infinity(), outer = -inner;
  const auto deviation = [side](const Opinion& of) { return side < 0 ? of.below : of.above; };
  for (const Opinion& of : opinions) {
    const double end = side * of.mean + kNormal95 * deviation(of);
    sum += of.weight;
    inner = std::min(inner, end);
    outer = std::max(outer, end);
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double end = (inner + outer) / 2;
    double tail = 0;
    for (const Opinion& of : opinions)
      tail += of.weight / sum * std::erfc((end - side * of.mean) / deviation(of) / std::numbers::sqrt2) / 2;
    (tail > kEachTail ? inner : outer) = end;
  }
  return side * outer;
}

Opinion opinion_of(const NoiseFit& fit, std::size_t i) {
  const double mean = 0.5 * std::log(fit.theta[i]);
  const Coefficient& term = fit.term[i];
  return {1, mean, std::log(*term.value / term.ci95.low) / kNormal95,
          std::log(term.ci95.high / *term.value) / kNormal95};
}

void reach_by(double shift, Coefficient& term) {
  term.ci95.low *= std::exp(std::min(0.0, shift));
  term.ci95.high *= std::exp(std::max(0.0, shift));
}

/// A term that was dropped is not known to be zero, nor that it stays dropped behind another shape.
ScoringResult likeliest(const BinProblem& problem, const ModelPoint& start, const TermSet& kept,
                        const TermSet& offered) {
  const ScoringResult first = score(problem, kept, &start);
  return score(problem, offered, &first.at);
}

/// Ends of the shifts of ln of a coefficient, and what the shapes say of it.
struct NeighbourReach {
  double least = 0, most = 0;
  std::vector<Opinion> opinions;
  double without = 0;  ///< weight of the shapes that need no such term
};

void extend(const NeighbourReach& by, Coefficient& term) {
  reach_by(by.least, term);
  reach_by(by.most, term);
  if (by.without > kEachTail) term.ci95.low = 0;  // beside the weight 1 of the shape that was chosen
  if (by.opinions.size() < 2) return;
  term.ci95.low = std::min(term.ci95.low, std::exp(end_of(by.opinions, -1)));
  term.ci95.high = std::max(term.ci95.high, std::exp(end_of(by.opinions, 1)));
}

void shift_to(const Mixture& theta, const NoiseFit& fit, std::array<NeighbourReach, kTerms>& reach) {
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!(theta[i] > 0 && fit.theta[i] > 0)) continue;
    const double shift = 0.5 * std::log(theta[i] / fit.theta[i]);
    reach[i].least = std::min(reach[i].least, shift);
    reach[i].most = std::max(reach[i].most, shift);
  }
}

/// The same family in `less` of the band, where it has to describe less of its flank.
void shift_to_narrower(const std::vector<PowerBin>& bins, const Band& band, double less, const TermSet& kept,
                       const NoiseFit& fit, std::array<NeighbourReach, kTerms>& reach) {
  constexpr double kAbove = 1.2;  ///< of the corner
  if (band.named.family == Family::none || band.named.family == Family::shelf || band.named.lag > 0) return;
  Band narrow = band;
  narrow.top_hz = less * std::min(band.top_hz, fit.rate_hz / 2);
  if (!(narrow.top_hz > kAbove * band.named.pole_hz)) return;
  for (std::size_t j = 0; j < bins.size(); ++j)
    if (bins[j].high_hz > narrow.top_hz * (1 + 1e-9)) narrow.inside[j] = 0;
  Band plain = narrow;
  plain.named = {};
  plain.orders = 0;
  const auto shape =
      fit_named_shape(bins_of(bins, plain, fit.rate_hz), fit.rate_hz, kept, band.named.family, band.named);
  if (!shape) return;
  narrow.named = *shape;
  const ModelPoint start{fit.theta, {}};
  shift_to(score(band_problem(bins, narrow, fit.rate_hz), kept, &start).at.theta, fit, reach);
}

/// Standard deviations of ln of the coefficients.
Mixture log_sds(const BinProblem& problem, const ModelPoint& at, const TermSet& terms) {
  const TermMatrix covariance = inverse_of(fisher_information(problem, at, terms), terms);
  Mixture out{};
  for (std::size_t i = 0; i < kTerms; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (at.theta[i] > 0) out[i] = 0.5 * std::sqrt(covariance(k, k)) / at.theta[i];
  }
  return out;
}

/// The opinion of a shape that knows a term to `unseen` at least.
void hear(const Mixture& theta, const Mixture& sd, double weight, double unseen,
          std::array<NeighbourReach, kTerms>& reach) {
  constexpr double kUnknown = std::numbers::ln10;  ///< standard deviation of what a shape hardly knows
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!(theta[i] > 0)) reach[i].without += weight;
    if (reach[i].opinions.empty() || !(theta[i] > 0) || !(sd[i] > 0) || sd[i] > unseen) continue;
    const double known = std::min(sd[i], kUnknown);
    reach[i].opinions.push_back({weight, 0.5 * std::log(theta[i]), known, known});
  }
}

/// Of terms that were not found without the high-pass.
void limit_by(const Mixture& theta, const Mixture& sd, const TermSet& kept, NoiseFit& fit) {
  for (std::size_t i = 0; i < kTerms; ++i) {
    Coefficient& term = fit.term[i];
    if (kept[i] || !term.upper95 || !(theta[i] > 0) || !(sd[i] > 0)) continue;
    term.upper95 = std::max(*term.upper95, std::sqrt(theta[i]) * std::exp(std::sqrt(kOneSided95) * sd[i]));
    term.ci95.high = std::max(term.ci95.high, std::sqrt(theta[i]) * std::exp(kNormal95 * sd[i]));
  }
}

/// What the shapes put decades apart was not seen.
void say_if_unknown(Term of, NoiseFit& fit) {
  constexpr double kFar = 10;
  Coefficient& term = fit.term[static_cast<std::size_t>(of)];
  if (!(term.ci95.high > kFar * *term.value)) return;
  if (term.status == Status::detected) term.status = Status::undetermined;
  fit.findings.push_back(
      finding("undetermined", fmt::format("Other filters describe the spectrum as well, and put {} elsewhere by "
                                          "more than a decade.",
                                          long_name(of))));
}

}  // namespace

void reach_to_neighbours(const std::vector<PowerBin>& bins, const Band& band, const ModelPoint& best,
                         const TermSet& offered, NoiseFit& fit) {
  constexpr double kAsLikely = 0.5, kMostLikelier = 300;  ///< of ln L
  const bool named = band.named.family != Family::none, taps = band.filter.kind != NoiseShape::Kind::none;
  const bool plain = is_plain(band);
  // Of an order, in ln L: equal weights are what many sensors have. And of what is hidden, which few have.
  constexpr double kOfWeights = 2, kOfHidden = 7.5;
  constexpr double kOfLimit = 3;   ///< of ln L, from which on limits know of a high-pass
  constexpr double kUnseen = 0.5;  ///< standard deviation of the level below a step that hardly has coefficients
  const auto price_of = [&](const Band& other) {
    return plain ? kOfHidden : (taps ? kOfWeights : 1) * (other.orders - band.orders - (band.low_pass ? 1 : 0));
  };
  if (band.named.family == Family::high_pass) return;
  const TermSet kept = only_positive(fit.theta);
  TermSet terms = kept;
  for (std::size_t i = 0; i < kTerms; ++i) terms[i] = terms[i] || offered[i];
  const std::vector<Band> others = neighbours_of(bins, band, kept, terms, fit.rate_hz);
  if (others.empty()) return;
  const double chosen = likeliest(band_problem(bins, band, fit.rate_hz), best, kept, terms).half_deviance;
  std::array<NeighbourReach, kTerms> reach;
  for (std::size_t i = 0; i < kTerms; ++i)
    if (fit.term[i].value && kept[i] && fit.term[i].ci95.low > 0 && std::isfinite(fit.term[i].ci95.high))
      reach[i].opinions = {opinion_of(fit, i)};
  for (const Band& other : others) {
    const BinProblem problem = band_problem(bins, other, fit.rate_hz);
    // The columns of a polynomial are those of the poorer one and more; a named shape begins at its maximum.
    const bool goes_on = other.named.family == Family::none;
    const ScoringResult there = likeliest(problem, goes_on ? best : ModelPoint{best.theta, {}}, kept, terms);
    const bool rises = other.named.zero_hz > 0 && other.named.pole_hz > other.named.zero_hz;
    const bool of_level = plain ? other.named.family != Family::high_pass : band.low_pass && rises;
    if (of_level && !shows_white_below(bins, other.named, there.at.theta)) continue;
    // Of a band that describes nothing a neighbour may be likelier than any number: all the weight is then its own.
    const double likelier = chosen - there.half_deviance - price_of(other);
    const double weight = std::exp(std::min(likelier, kMostLikelier));
    if (!(weight > 0)) continue;
    const bool shifts = !plain && there.half_deviance < chosen + kAsLikely && (named || other.orders > band.orders);
    if (shifts) shift_to(there.at.theta, fit, reach);
    const Mixture sd = log_sds(problem, there.at, terms);
    hear(there.at.theta, sd, weight, plain ? kUnseen : std::numeric_limits<double>::infinity(), reach);
    const bool falls = plain && other.named.family == Family::high_pass;
    if (falls && likelier > kOfLimit - kOfHidden) limit_by(there.at.theta, sd, kept, fit);
  }
  for (const double less : {std::numbers::sqrt2 / 2, 0.5}) shift_to_narrower(bins, band, less, kept, fit, reach);
  for (std::size_t i = 0; i < kTerms; ++i)
    if (fit.term[i].value) {
      extend(reach[i], fit.term[i]);
      say_if_unknown(static_cast<Term>(i), fit);
    }
}

}  // namespace libchar
