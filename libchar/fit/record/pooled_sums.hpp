#pragma once
// Sums of squared coefficients of transforms of one length.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/numeric/state_archive.hpp"

namespace libchar::detail {

struct PooledSums {
  std::uint64_t transforms = 0;
  std::vector<double> power;  ///< sums of c_k² at [k]; empty: no transform, or not kept
};

/// One more transform, or as many of its coefficients as are kept.
void add_squares(std::span<const double> coefficients, PooledSums& sums);
void join(PooledSums& sums, const PooledSums& later);

void write_state(const PooledSums& sums, StateWriter& to);
/// Of transforms with this number of kept coefficients.
PooledSums read_pooled_sums(std::uint64_t kept, StateReader& from);

// Sums of squared coefficients of transforms of means (detail/mean_series.hpp).

inline constexpr std::uint64_t kMeansBlock = std::uint64_t{1} << 15U;

/// Of each transform the coefficients that transforms of the samples leave to it.
struct MeanPowers {
  PooledSums blocks;
  /// what fills no block, where that is much and often: pieces of 2^14, 2^13 … 2^6 means
  std::array<PooledSums, 9> pieces;

  static std::uint64_t piece_length(std::size_t piece) { return kMeansBlock >> (piece + 1); }
};

void join(MeanPowers& powers, const MeanPowers& later);

void write_state(const MeanPowers& powers, StateWriter& to);
/// Of means of `per_mean` samples, which blocks of `block` samples leave something.
MeanPowers read_mean_powers(std::uint64_t per_mean, std::uint64_t block, StateReader& from);

}  // namespace libchar::detail

namespace libchar {
using namespace detail;
}
