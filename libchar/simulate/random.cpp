// Philox4x64-10: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as
// easy as 1, 2, 3", SC 2011; the round function is that of the Random123 library. Normal deviates
// by the ziggurat of Boost.Random (Marsaglia and Tsang, J. Stat. Softw. 5 (2000) 8, with the 53
// bits of the deviate and the 8 bits of layer and sign taken from different bits of one word).

#include "libchar/simulate/random.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <limits>

namespace libchar {

namespace {

inline r123::Philox4x64::ctr_type block_at(const StreamKey& key, std::uint64_t position, std::uint64_t further) {
  const r123::Philox4x64::ctr_type counter = {{position, further, 0, static_cast<std::uint64_t>(key.purpose)}};
  return r123::Philox4x64()(counter, {{key.seed, key.sensor}});
}

/// The words of one deviate: the first from the stream, those that one deviate in 36 needs beyond it (ziggurat
/// rejections, the tail) from blocks of its own, so that they do not move the next deviate.
class DeviateWords {
 public:
  using result_type = std::uint64_t;
  DeviateWords(const StreamKey& key, std::uint64_t position, std::uint64_t first)
      : key_(key), position_(position), first_(first) {}
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()() {
    if (used_++ == 0) return first_;
    return further(used_ - 2);
  }

 private:
  result_type further(std::uint64_t n) const { return block_at(key_, position_, 1 + n / 4)[n % 4]; }
  const StreamKey& key_;
  std::uint64_t position_, first_, used_ = 0;
};

double normal_at(const StreamKey& key, std::uint64_t position, std::uint64_t word) {
  DeviateWords words(key, position, word);
  boost::random::normal_distribution<double> distribution;
  return distribution(words);
}

}  // namespace

std::array<std::uint64_t, 4> philox(const std::array<std::uint64_t, 4>& counter,
                                    const std::array<std::uint64_t, 2>& key) {
  const auto out = r123::Philox4x64()({{counter[0], counter[1], counter[2], counter[3]}}, {{key[0], key[1]}});
  return {out[0], out[1], out[2], out[3]};
}

// Sixteen blocks at once: they do not depend on each other, so the processor overlaps them.
void DeviateStream::refill() {
  const std::uint64_t first = position_ / kWords * (kWords / 4);
  for (std::size_t i = 0; i < kWords; i += 4) {
    const auto four = block_at(key_, first + i / 4, 0);
    words_[i] = four.v[0];
    words_[i + 1] = four.v[1];
    words_[i + 2] = four.v[2];
    words_[i + 3] = four.v[3];
  }
  filled_ = true;
}

void DeviateStream::seek(std::uint64_t position) {
  position_ = position;
  filled_ = false;
}

double DeviateStream::normal() {
  double value = 0;
  fill_normal({&value, 1});
  return value;
}

double DeviateStream::uniform() {
  if (!filled_) refill();
  const std::uint64_t word = words_[position_ % kWords];
  filled_ = ++position_ % kWords != 0;
  return static_cast<double>(word >> 11U) * 0x1.0p-53;
}

void DeviateStream::fill_normal(std::span<double> out) {
  for (std::size_t done = 0; done < out.size();) {
    if (!filled_) refill();
    const std::size_t at = position_ % kWords, count = std::min(kWords - at, out.size() - done);
    for (std::size_t i = 0; i < count; ++i) out[done + i] = normal_at(key_, position_ + i, words_[at + i]);
    done += count;
    position_ += count;
    filled_ = at + count < kWords;
  }
}

}  // namespace libchar
