// Philox4x64-10: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as
// easy as 1, 2, 3", SC 2011; the round function is that of the Random123 library. Normal deviates
// by the ziggurat of Boost.Random (Marsaglia and Tsang, J. Stat. Softw. 5 (2000) 8, with the 53
// bits of the deviate and the 8 bits of layer and sign taken from different bits of one word).

#include "libchar/simulate/random.hpp"

#include <Random123/philox.h>

#include <boost/random/normal_distribution.hpp>

namespace libchar {

std::array<std::uint64_t, 4> philox(const std::array<std::uint64_t, 4>& counter,
                                    const std::array<std::uint64_t, 2>& key) {
  const r123::Philox4x64::ctr_type from = {{counter[0], counter[1], counter[2], counter[3]}};
  const r123::Philox4x64::key_type with = {{key[0], key[1]}};
  const r123::Philox4x64::ctr_type out = r123::Philox4x64()(from, with);
  return {out[0], out[1], out[2], out[3]};
}

// Sixteen blocks at once: they do not depend on each other, so the processor overlaps them.
void BitStream::refill() {
  const auto purpose = static_cast<std::uint64_t>(key_.purpose);
  for (std::size_t i = 0; i < kWords; i += 4) {
    const auto four = philox({block_++, 0, 0, purpose}, {key_.seed, key_.sensor});
    for (std::size_t j = 0; j < 4; ++j) words_[i + j] = four[j];
  }
  next_ = 0;
}

double DeviateStream::normal() {
  boost::random::normal_distribution<double> distribution;
  return distribution(bits_);
}

void DeviateStream::fill_normal(std::span<double> out) {
  boost::random::normal_distribution<double> distribution;
  for (double& value : out) value = distribution(bits_);
}

}  // namespace libchar
