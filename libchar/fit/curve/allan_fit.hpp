#pragma once
// The covariance-weighted fit of the Allan curve: the second opinion.

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

/// What the fits of one log's channels share, from any number of threads: it saves time and changes no result.
struct FitWorkspace {
  AllanCovarianceCache covariances;
};

/// Generalised least squares of the Allan variances with the model's own covariance, on the terms of `first` that have
/// a value; compared with `first`. Nothing when the curve has too few points. `cache` may be null.
std::optional<SecondOpinion> second_opinion(const AllanCurve& curve, const NoiseFit& first,
                                            AllanCovarianceCache* cache);

}  // namespace libchar
