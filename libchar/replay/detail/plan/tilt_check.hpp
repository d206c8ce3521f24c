#pragma once
// Do the gyroscope and the accelerometers of a tilt see one rotation? Over windows of a second, with G the mean of the
// integrated rate and A the direction of the mean acceleration, the changes dG and dA from window to window are the
// same, whatever the angle does within them, but for noise and an offset of the rate:
//   correlation r of dA and dG, and the ratio sd(dG) / sd(dA) of their sizes.
// Accelerations that are not gravity lower r; they neither turn its sign nor make the rate larger. Those of a lever arm
// l follow the angle, l w^2 / g of it (15 % at 0.15 m and half a hertz): a gain of an accelerometer that is off by less
// cannot be told from them. A delay can, being in phase with the rate: d is the regression of dG - dA on the change
// of the mean rate.

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
    double count = 0, integral = 0, x = 0, z = 0;
    double from = 0;  ///< the integral before it
    bool whole = true;
  };
  void close();
  double delay_s() const;

  fusion::TiltChannels channels_;
  double step_s_ = 0;
  std::int64_t length_ = 0;
  Window now_;
  double integrated_ = 0;  // of the rate, from the start on
  bool has_last_ = false;
  double last_g_ = 0, last_a_ = 0, last_rate_ = 0;
  double rr_ = 0, re_ = 0, ee_ = 0;                          // of changes of the mean rate, and of e = dG - dA
  double n_ = 0, g_ = 0, a_ = 0, gg_ = 0, ga_ = 0, aa_ = 0;  // sums of the changes
};

}  // namespace libchar::detail
