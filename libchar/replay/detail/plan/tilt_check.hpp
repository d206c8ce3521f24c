#pragma once
// Do the gyroscope and the accelerometers of a tilt see one rotation? Over windows of a second, with
// G the mean of the integrated rate and A the direction of the mean acceleration, the changes dG and
// dA from window to window are the same, whatever the angle does within them, but for noise and an
// offset of the rate:
//   correlation r of dA and dG, and the ratio sd(dG) / sd(dA) of their sizes.
// Accelerations that are not gravity lower r; they neither turn its sign nor make the rate larger.

#include <Eigen/Core>
#include <cstdint>

#include "libchar/core/finding.hpp"
#include "libchar/fusion/algorithm.hpp"

namespace libchar::detail {

class TiltCheck {
 public:
  TiltCheck(const fusion::TiltChannels& channels, double rate_hz);
  /// Consecutive instants; a window with a missing sample is left out.
  void push(const Eigen::MatrixXd& samples);
  /// Adds "tilt_contradicts" where they do not.
  void tell(Findings& warnings) const;

 private:
  struct Window {
    double count = 0, integral = 0, sum = 0, x = 0, z = 0;
    bool whole = true;
  };
  void close();

  fusion::TiltChannels channels_;
  double step_s_ = 0;
  std::int64_t length_ = 0;
  Window now_;
  double integrated_ = 0;  // of the rate, from the start on
  bool has_last_ = false;
  double last_g_ = 0, last_a_ = 0;
  double n_ = 0, g_ = 0, a_ = 0, gg_ = 0, ga_ = 0, aa_ = 0;  // sums of the changes
};

}  // namespace libchar::detail
