#pragma once
// Bias and degrees of freedom of the statistics beside plain differences.

#include <cstdint>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Expected modified or Hadamard total variance over the modified or Hadamard one, for the mixture
/// at the point: as SP 1065, 5.4, states it. 1 of all others.
double family_bias(const DeviationRow& row,
                   const Mixture& theta,
                   const AllanPoint& point,
                   double dt_s);

/// Equivalent degrees of freedom at a point from `samples` rate samples (family_dof.cpp), at least 1.
double family_dof(const DeviationRow& row,
                  const Mixture& theta,
                  const AllanPoint& point,
                  std::uint64_t samples,
                  double dt_s);

}  // namespace libchar
