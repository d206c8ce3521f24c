#pragma once
// Do the gyroscope and the accelerometers of a tilt see one rotation? Over windows of a second, with G the mean of the
// integrated rate and A the direction of the mean acceleration, the changes dG and dA from window to window are the
// same, whatever the angle does within them, but for noise and an offset of the rate:
//   correlation r of dA and dG, and the ratio sd(dG) / sd(dA) of their sizes.
// Accelerations that are not gravity lower r; they neither turn its sign nor make the rate larger. Those of a lever arm
// l follow the angle, l w^2 / g of it (15 % at 0.15 m and half a hertz): a gain of an accelerometer that is off by less
// cannot be told from them. A delay can, being in phase with the rate: d is the regression of dG - dA on the change
// of the mean rate. Where there is a reference, its changes dR tell which of the two is wrong, or that it is the
// reference; against them the rate is judged to 5 %.

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "libchar/core/finding.hpp"
#include "libchar/fusion/algorithm.hpp"

namespace libchar::detail {

class TiltCheck {
 public:
  TiltCheck(const fusion::TiltChannels& channels, double rate_hz);
  /// Consecutive instants; a window with a missing sample is left out. `truth`: a row of angles in rad, or none.
  void push(const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth);
  /// Adds "tilt_contradicts" where they do not.
  void tell(Findings& warnings) const;

 private:
  struct Window {
    double count = 0, integral = 0, x = 0, z = 0, reference = 0;
    double from = 0;  ///< the integral before it
    bool whole = true;
  };
  /// Changes of two angles from window to window.
  struct Pair {
    double n = 0, a = 0, b = 0, aa = 0, ab = 0, bb = 0;
    void push(double da, double db);
    bool moves() const;  ///< b does, often enough to judge a by it
    double correlation() const;
    double ratio() const;  ///< of a over b
    bool opposite() const;
    bool other_size() const;
  };
  void close();
  double delay_s() const;
  std::string by_reference() const;
  void tell_reference(Findings& warnings) const;

  fusion::TiltChannels channels_;
  double step_s_ = 0;
  std::int64_t length_ = 0;
  Window now_;
  double integrated_ = 0;  // of the rate, from the start on
  double turned_ = 0;      // the reference, without jumps of whole turns
  bool has_last_ = false;
  struct {
    double g = 0, a = 0, r = 0, rate = 0;
  } last_;
  double rr_ = 0, re_ = 0, ee_ = 0;                          // of changes of the mean rate, and of e = dG - dA
  Pair gravity_, rate_by_reference_, gravity_by_reference_;  // dG by dA, dG by dR, dA by dR
};

}  // namespace libchar::detail
