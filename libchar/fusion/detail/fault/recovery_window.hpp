#pragma once
// Whether a sensor agrees with the others again: sums over its last own samples, in eight parts, of the
// innovation e (sample less what the others say), of variance s.
//
//   (sum z)^2 / n,  (sum x e)^2 / (sum x^2 s),  (sum z^2 - n) / sqrt(2 n),     z = e / sqrt(s)
//
// Each is a standard test of mean, gain and variance; all must pass. Where the fault was seen in the gain,
// the input must have moved enough to show it again.

#include <array>
#include <cmath>
#include <cstdint>

namespace libchar::fusion {

class RecoveryWindow {
 public:
  /// `early`: the alarm itself is in doubt. A quarter of the window is looked at too, once, and a gain need
  /// not be shown again.
  void start(std::int64_t length, bool early = false) {
    *this = RecoveryWindow{};
    early_ = early;
    part_length_ = std::max<double>(static_cast<double>(length) / kParts, 1);
  }
  /// True when a part is full and the window with it.
  bool add(double e, double s, double x) {
    Sums& part = parts_[part_];
    const double z = e / std::sqrt(s);
    part.n += 1;
    part.z += z;
    part.zz += std::min(z * z, 1e12);
    part.xe += x * e / s;
    part.xx += x * x / s;
    if (part.n < part_length_) return false;
    total();
    part_ = (part_ + 1) % kParts;
    parts_[part_] = {};
    full_ = std::min(full_ + 1, kParts + 1);
    if (full_ >= 2) remember_gain();
    return full_ >= kParts || (early_ && full_ == kParts / 4);
  }
  /// Mean and slope are no more than the scatter makes them.
  bool mean_fits() const { return full_ >= kParts && fits(1, 1, std::max(sum_.zz / sum_.n, 1.0)); }
  /// z is worth `bias` of itself in a sum, x z `gain`, z^2 - 1 `noise` (long-run variances).
  bool all_fit(double bias, double gain, double noise) const {
    return fits(bias, gain, 1) && excess() * noise < 3.3;
  }
  /// The window is the first: nothing was ever wrong in it.
  bool first() const { return full_ <= kParts; }
  /// Mean square of z.
  double scatter() const { return sum_.zz / sum_.n; }

 private:
  static constexpr std::size_t kParts = 8;
  static constexpr double kLimit = 10.8;  // chi square of one, p = .001
  struct Sums {
    double n = 0, z = 0, zz = 0, xe = 0, xx = 0;
  };
  void total() {
    sum_ = {};
    for (const Sums& part : parts_) {
      sum_.n += part.n;
      sum_.z += part.z;
      sum_.zz += part.zz;
      sum_.xe += part.xe;
      sum_.xx += part.xx;
    }
  }
  /// The fault was one of gain when the slope explains more than the mean does.
  void remember_gain() {
    if (!(sum_.xx > 0)) return;
    const double explained = sum_.xe * sum_.xe / sum_.xx;
    if (explained > 25 && explained > sum_.z * sum_.z / sum_.n)
      gain_ = std::max(gain_, std::abs(sum_.xe / sum_.xx));
  }
  bool fits(double bias, double gain, double scatter) const {
    if (!early_ && gain_ * gain_ * sum_.xx < (gain_ > 0 ? 30 : 0)) return false;
    const double slope = sum_.xx > 0 ? sum_.xe * sum_.xe / sum_.xx : 0;
    return sum_.z * sum_.z / sum_.n * bias * bias < kLimit * scatter &&
           slope * gain * gain < kLimit * scatter;
  }
  double excess() const { return (sum_.zz - sum_.n) / std::sqrt(2 * sum_.n); }

  std::array<Sums, kParts> parts_{};
  Sums sum_;
  std::size_t part_ = 0, full_ = 0;
  bool early_ = false;
  double part_length_ = 25, gain_ = 0;
};

}  // namespace libchar::fusion
