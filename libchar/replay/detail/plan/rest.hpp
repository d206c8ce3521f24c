#pragma once
// What a stretch at rest tells about each sensor: its offset and the level of its noise.
//   offset   mean of the samples
//   noise    half the mean square of successive differences, the Allan variance at one sample: slow
//            drift hardly enters, a constant input not at all

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace libchar {

class RestMeter {
 public:
  explicit RestMeter(std::size_t sensors) : sensors_(sensors) {}
  /// Consecutive instants, a column each; NaN = missing.
  void push(const Eigen::MatrixXd& samples);
  std::vector<double> means() const;            ///< 0 without a sample
  std::vector<double> noise_variances() const;  ///< NaN without a difference
  /// About the mean; NaN without two samples. Of filtered samples, which have no drift, and of
  /// which neighbours are alike.
  std::vector<double> variances() const;

 private:
  struct Sums {
    double origin = 0, sum = 0, squares = 0, differences = 0, last = 0;
    std::uint64_t samples = 0, pairs = 0;
    bool has_last = false;
  };
  std::vector<Sums> sensors_;
};

}  // namespace libchar
