#pragma once
// Points of a record with missing samples.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_sums.hpp"

namespace libchar {

/// Are its terms differences of means, so that those of what is present will do?
bool of_window_means(const DeviationRow& row);

/// Points at the ascending `factors` from means over what is present (present_points.cpp); no
/// terms where there is no estimate.
std::vector<AllanPoint> points_of_present(std::span<const double> rate, const DeviationRow& row,
                                          const std::vector<std::uint64_t>& factors, double dt_s);

/// Says what was taken off for missing samples, and at how many averaging times (`without`,
/// ascending) there is no estimate.
void note_missing(const std::vector<std::uint64_t>& without, AllanCurve& curve);

// The Allan variance of a record with missing samples: what its terms sum up to, and what is taken
// off for what is missing.

/// A window of m samples has a mean when more than half of it is there.
constexpr bool has_mean(double present, double m) { return 2 * present > m; }

/// What missing samples add to the mean square of d, scale by scale (present_points.cpp).
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
  Corrected corrected(double m, const PresentTerms& terms, double divisor, double unit, double dof) const;
  /// The Allan terms of the next octave, m = 1, 2, 4 …, and the variance that was found for it; not positive: none.
  void add_octave(double m, const PresentTerms& terms, long double variance);

 private:
  long double spread(double m) const;
  long double weighted_ = 0, weight_ = 0;
  double hidden_from_ = std::numeric_limits<double>::infinity();
  std::vector<long double> spread_;  ///< S²(2), S²(4), …
};

}  // namespace libchar
