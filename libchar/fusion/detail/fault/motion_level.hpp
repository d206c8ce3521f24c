#pragma once
// Noise that follows the motion: the variance of a sensor's z by the size u of the input, x over its root mean square.
//
//   v(u) = mean of z^2 where |x| is about u, over that of all;  z <- z / sqrt(v)
//
// z^2 counts 16 at most, so that outliers do not; bins are of a quarter of the root mean square, and v is linear
// between their middles. It is 1 unless some bins have clearly more than others: for Gaussian noise nothing changes.

#include <array>
#include <cstddef>
#include <vector>

namespace libchar::fusion {

class MotionLevel {
 public:
  /// Memory in samples that are added of a sensor.
  static constexpr double kMemory = 10000;
  explicit MotionLevel(std::size_t sensors) : sensors_(sensors) {}
  bool any() const { return any_; }
  /// v for the input's distance from its mean.
  double at(std::size_t sensor, double x) const;
  /// z of before it was divided by sqrt(v).
  void add(std::size_t sensor, double x, double z);
  /// After so many samples.
  void renew(double samples);

 private:
  static constexpr std::size_t kBins = 16;
  struct Sensor {
    double square = 0, count = 0;  ///< mean square of x, of so many
    bool differs = false;
    std::array<double, kBins> sums{}, counts{}, level{};
  };
  static void find_level(Sensor& sensor);
  std::vector<Sensor> sensors_;
  bool any_ = false;
};

}  // namespace libchar::fusion
