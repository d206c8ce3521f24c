// Of a block of L = 2^15 means of p samples the coefficients 16 … 15.5 p L / block are used: those
// above are of the transforms of the samples (blocks of `block`), those below of the series of
// means of 512 means, with the resolution of the whole segment. Both have their exact expectations
// (BlockMeanDct, of L means of p samples and of n means of 512 p).
#include "libchar/fit/detail/record/mean_series.hpp"

#include <cmath>

#include "libchar/core/numeric/whole.hpp"

namespace libchar {

std::vector<double> slow_means(std::span<const double> means) {
  std::vector<double> slow;
  slow.reserve(means.size() / kMeansPerSlow);
  for (; means.size() >= kMeansPerSlow; means = means.subspan(kMeansPerSlow)) {
    double sum = 0;
    for (const double mean : means.first(kMeansPerSlow)) sum += mean;
    slow.push_back(sum / std::sqrt(static_cast<double>(kMeansPerSlow)));
  }
  return slow;
}

std::size_t MeanCutter::take_blocks(std::span<const double> means, MeanPowers& to) {
  std::size_t taken = 0;
  for (; means.size() - taken >= kMeansBlock; taken += kMeansBlock) {
    if (!plan_) plan_.emplace(kMeansBlock);
    const std::span<const double> c = plan_->transform(means.subspan(taken, kMeansBlock));
    add_squares(c.first(detail::in_memory(end_of_left(kMeansBlock, per_mean_, block_))), to.blocks);
  }
  return taken;
}

void MeanCutter::take_pieces(std::span<const double> rest, MeanPowers& to) const {
  for (std::size_t piece = 0; piece < to.pieces.size(); ++piece) {
    const std::size_t length = detail::in_memory(MeanPowers::piece_length(piece));
    if (rest.size() < length) continue;
    Dct plan(length);
    const std::size_t end = detail::in_memory(end_of_left(length, per_mean_, block_));
    add_squares(plan.transform(rest.first(length)).first(end), to.pieces[piece]);
    rest = rest.subspan(length);
  }
}

void append_powers(const MeanPowers& powers, std::uint64_t per_mean, std::vector<PooledPower>& out) {
  for (std::size_t piece = 0; piece < powers.pieces.size(); ++piece) {
    const std::size_t length = detail::in_memory(MeanPowers::piece_length(piece));
    append_pooled(powers.pieces[piece], length, per_mean, first_kept(length, kMeansBlock), out);
  }
  append_pooled(powers.blocks, kMeansBlock, per_mean, kLeftToMeans, out);
}

void append_slow(std::span<const double> rest, std::vector<double> slow, std::uint64_t per_mean, std::uint64_t block,
                 std::vector<PooledPower>& out) {
  const std::uint64_t first = first_kept(rest.size(), kMeansBlock), end = end_of_left(rest.size(), per_mean, block);
  if (rest.size() >= kSmallestTransform && first < end) out.push_back(record_power(rest, per_mean, first, end));
  const std::vector<double> last = slow_means(rest);
  slow.insert(slow.end(), last.begin(), last.end());
  if (slow.size() < kSmallestTransform) return;
  out.push_back(record_power(slow, per_mean * kMeansPerSlow, 1, end_of_left(slow.size(), kMeansPerSlow, kMeansBlock)));
}

}  // namespace libchar
