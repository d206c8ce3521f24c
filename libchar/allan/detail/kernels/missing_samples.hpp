#pragma once
// The Allan variance of a record with missing samples: what its terms sum up to, and what is taken
// off for what is missing.

#include <limits>
#include <vector>

#include "libchar/allan/allan_sums.hpp"

namespace libchar {

/// A window of m samples has a mean when more than half of it is there.
constexpr bool has_mean(double present, double m) {
  return 2 * present > m;
}

/// What missing samples add to the mean square of d, scale by scale (missing_samples.cpp).
class MissingSamples {
 public:
  struct Corrected {
    /// sum d² / (divisor n) less what missing samples add; negative: nothing known
    long double variance = -1;
    double inflation = 1;  ///< of the relative standard deviation
    double added = 0;      ///< what was taken off
  };
  /// `divisor` 2 for Allan terms, 6 for Hadamard's; `unit`: the variance of white noise of variance
  /// 1, none missing; `dof` of the terms in white noise.
  Corrected corrected(
      double m, const PresentTerms& terms, double divisor, double unit, double dof) const;
  /// The Allan terms of the next octave, m = 1, 2, 4 …, and the variance that was found for it; not positive: none.
  void add_octave(double m, const PresentTerms& terms, long double variance);

 private:
  long double spread(double m) const;
  long double weighted_ = 0, weight_ = 0;
  double hidden_from_ = std::numeric_limits<double>::infinity();
  std::vector<long double> spread_;  ///< S²(2), S²(4), …
};

}  // namespace libchar
