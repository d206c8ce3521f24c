#pragma once
// The series of means of a record, and of a long one its slow part: blocks of 2^15 means are transformed and their
// squares pooled, as the samples are, and the coefficients that these leave are taken from the series of means of 512
// means. So nothing grows with a record but one value for 2^18 samples, and no transform does.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/fit/detail/record/record_powers.hpp"
#include "libchar/fit/record/pooled_sums.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {

inline constexpr std::uint64_t kMeansPerSlow = kMeansBlock / kMeansPerBlock;

/// Means of 512 means, times sqrt(512): on the same scale. What is left behind them is in none.
std::vector<double> slow_means(std::span<const double> means);

/// Blocks of means as one series has them, and the pieces of its rest (at most 63 means are in
/// none). `per_mean` samples each, of blocks of `block` samples.
class MeanCutter {
 public:
  MeanCutter(std::uint64_t per_mean, std::uint64_t block) : per_mean_(per_mean), block_(block) {}
  /// As many whole blocks as there are; how many means that were.
  std::size_t take_blocks(std::span<const double> means, MeanPowers& to);
  void take_pieces(std::span<const double> rest, MeanPowers& to) const;

 private:
  std::uint64_t per_mean_, block_;
  std::optional<Dct> plan_;
};

/// Blocks and pieces.
void append_powers(const MeanPowers& powers, std::uint64_t per_mean, std::vector<PooledPower>& out);
/// The end of a long series: `rest` fills no block and is one transform of its own, `slow` is of
/// all of it but for `rest`.
void append_slow(std::span<const double> rest, std::vector<double> slow, std::uint64_t per_mean, std::uint64_t block,
                 std::vector<PooledPower>& out);

}  // namespace libchar
