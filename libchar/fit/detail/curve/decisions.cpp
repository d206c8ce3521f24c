// A term whose true value is zero improves 2 ln L by half a chi-square with one degree of freedom
// and half a zero (boundary of theta >= 0): threshold 5.41 is passed by 1 % of such terms.
// Elimination runs backward from the full set, least needed first. Flicker and walk may each be
// dispensable while the other is there and yet not both (docs/theory/fit.md): then both are kept and
// reported as undetermined.
#include "libchar/fit/detail/curve/decisions.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "libchar/fit/detail/band/scoring.hpp"

namespace libchar {
namespace {

/// Maxima of all submodels, each computed once when asked for.
class Submodels {
 public:
  explicit Submodels(const BinProblem& problem) : problem_(problem) {}

  const ScoringResult& at(const TermSet& set) {
    std::size_t key = 0;
    for (std::size_t i = 0; i < kTerms; ++i) key |= set[i] ? std::size_t{1} << i : 0;
    if (!known_[key]) {
      known_[key] = score(problem_, set);
      iterations += known_[key]->iterations;
    }
    return *known_[key];
  }

  /// 2 (lnL of `set` with the term - lnL of `set` without it).
  double ratio(TermSet set, std::size_t term) {
    set[term] = true;
    const double with = at(set).half_deviance;
    set[term] = false;
    if (count_of(set) == 0) return std::numeric_limits<double>::infinity();
    const double without = at(set).half_deviance;
    return std::isfinite(without) ? std::max(0.0, 2 * (without - with))
                                  : std::numeric_limits<double>::infinity();
  }

  int iterations = 0;

 private:
  const BinProblem& problem_;
  std::array<std::optional<ScoringResult>, 1U << kTerms> known_;
};

constexpr auto kFlicker = static_cast<std::size_t>(Term::flicker);
constexpr auto kWalk = static_cast<std::size_t>(Term::walk);

bool cannot_tell(Submodels& models, const TermSet& set, double threshold) {
  if (!set[kFlicker] || !set[kWalk]) return false;
  TermSet neither = set;
  neither[kFlicker] = neither[kWalk] = false;
  if (count_of(neither) == 0) return false;
  const double both = 2 * (models.at(neither).half_deviance - models.at(set).half_deviance);
  return models.ratio(set, kFlicker) < threshold && models.ratio(set, kWalk) < threshold &&
         both > threshold;
}

}  // namespace

Decision decide(const BinProblem& problem, const TermSet& offered, double threshold) {
  Submodels models(problem);
  Decision decision;
  TermSet set = offered;
  for (;;) {
    if (threshold > 0 && cannot_tell(models, set, threshold)) decision.flicker_or_walk = true;
    std::size_t weakest = kTerms;
    double least = threshold;
    for (std::size_t i = 0; i < kTerms && count_of(set) > 1; ++i) {
      if (!set[i] || (decision.flicker_or_walk && (i == kFlicker || i == kWalk))) continue;
      const double ratio = models.ratio(set, i);
      if (ratio < least) {
        least = ratio;
        weakest = i;
      }
    }
    if (weakest == kTerms) break;
    set[weakest] = false;
  }
  const ScoringResult& best = models.at(set);
  decision.kept = set;
  decision.at = best.at;
  decision.half_deviance = best.half_deviance;
  decision.converged = best.converged;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!offered[i]) continue;
    decision.likelihood_ratio[i] = models.ratio(set, i);
    decision.ratio_in_all[i] = models.ratio(offered, i);
  }
  decision.iterations = models.iterations;
  return decision;
}

}  // namespace libchar
