#pragma once
// Sensors that repeat another one, sample by sample, as far as a float tells: one channel recorded twice is one sensor.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace libchar {

class CopiedSensors {
 public:
  /// A row a sensor, a column an instant; NaN: missing.
  void push(const Eigen::MatrixXd& samples);
  /// The earlier sensor that this one repeated throughout, in a hundred instants at least; none: none.
  std::optional<std::size_t> original_of(std::size_t sensor) const;

 private:
  struct Pair {
    Eigen::Index copy, original;
    std::uint64_t instants = 0;
  };
  void find_pairs(const Eigen::MatrixXd& samples);
  std::vector<Pair> pairs_;
  bool begun_ = false;
};

}  // namespace libchar
