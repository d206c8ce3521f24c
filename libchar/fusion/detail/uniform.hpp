#pragma once
// Random numbers that are the same everywhere.

#include <cstdint>

namespace libchar::fusion {

/// SplitMix64 (Steele, Lea, Flood 2014): a few thousand weights need no more.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : state_(seed) {}
  /// In (-1, 1).
  double operator()() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    z ^= z >> 31U;
    return (static_cast<double>(z >> 11U) + 0.5) * 0x1p-52 - 1;
  }

 private:
  std::uint64_t state_;
};

}  // namespace libchar::fusion
