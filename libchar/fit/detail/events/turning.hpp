#pragma once
// Sines and cosines of the multiples of an angle, at the price of four products each.

#include <cmath>
#include <cstdint>
#include <numbers>

namespace libchar {

/// sin and cos of k a for k = 1, 2, …: a turn from one to the next, set right every 256.
class Turning {
 public:
  explicit Turning(double angle) : angle_(angle), c1_(std::cos(angle)), s1_(std::sin(angle)) {}
  void next() {
    ++k_;
    if (k_ % 256 == 0) {
      const double at = std::fmod(angle_ * static_cast<double>(k_), 2 * std::numbers::pi);
      cosine = std::cos(at);
      sine = std::sin(at);
      return;
    }
    const double c = cosine * c1_ - sine * s1_;
    sine = sine * c1_ + cosine * s1_;
    cosine = c;
  }
  double cosine = 1, sine = 0;

 private:
  double angle_, c1_, s1_;
  std::uint64_t k_ = 0;
};

}  // namespace libchar
