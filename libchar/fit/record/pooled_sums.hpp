#pragma once
// Sums of squared coefficients of transforms of one length.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/numeric/state_archive.hpp"

namespace libchar {

struct PooledSums {
  std::uint64_t transforms = 0;
  std::vector<double> power;  ///< sums of c_k² at [k]; none: no transform, or none that was kept
};

/// One more transform, or as many of its coefficients as are kept.
void add_squares(std::span<const double> coefficients, PooledSums& sums);
void join(PooledSums& sums, const PooledSums& later);

void write_state(const PooledSums& sums, StateWriter& to);
/// Of transforms of which so many coefficients are kept.
PooledSums read_pooled_sums(std::uint64_t kept, StateReader& from);

}  // namespace libchar
