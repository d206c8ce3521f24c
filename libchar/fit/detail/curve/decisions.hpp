#pragma once
// Which terms are in the record: likelihood ratios at the boundary, backward elimination.

#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

struct Decision {
  TermSet kept{};  ///< terms of the reported model
  ModelPoint at;   ///< its maximum
  double half_deviance = 0;
  /// 2 (lnL with - lnL without): of a kept term within the model, of a dropped one when it is added
  Mixture likelihood_ratio{};
  Mixture ratio_in_all{};        ///< the same within the model of all offered terms
  bool flicker_or_walk = false;  ///< neither is needed when the other is there, but one of them is
  int iterations = 0;
  bool converged = true;
};

Decision decide(const BinProblem& problem, const TermSet& offered, double threshold);

}  // namespace libchar
