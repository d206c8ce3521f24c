#pragma once
// Before fusion: what makes sensors of one quantity differ that is no noise, and how to take it out.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libchar/fusion/delay_taps.hpp"

namespace libchar::fusion {

/// One channel against the common input x:  y(t) = bias + (1 + gain) x(t - delay) + sum m_k c_k(t).
struct ChannelAlignment {
  double delay = 0;           ///< in samples; positive: the channel is late
  double bias = 0, gain = 0;  ///< in units of x; a ratio
  std::vector<double> cross;  ///< m_k, of each other axis
  /// Standard errors (jackknife over stretches, so that correlation counts); NaN: left at nominal.
  double delay_se = kUnknown, bias_se = kUnknown, gain_se = kUnknown;
  std::vector<double> cross_se;
  bool used = true;  ///< false: too few samples, or constant: left as it is
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
};

/// Samples of a channel at or beyond its limits are those of a saturated sensor.
struct ChannelLimits {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool hold(double y) const { return y > low && y < high; }
};

struct Alignment {
  std::vector<ChannelAlignment> channels;
  Interpolation interpolation = Interpolation::sinc;
  std::vector<ChannelLimits> limits;  ///< of all rows of the samples, those of other axes included
  std::int64_t instants = 0;          ///< it was learnt from
  std::vector<std::string> notes;     ///< what the stretch could not tell, sentences
};

/// The mean over the sensors of each further axis at one instant, saturated samples left out.
void cross_means(const Alignment& alignment,
                 const Eigen::Ref<const Eigen::VectorXd>& column,
                 Eigen::VectorXd& means);

/// Aligned samples with their biases, gains and other axes put back: what the delays alone do.
Eigen::VectorXd in_time(const Alignment& alignment,
                        const Eigen::VectorXd& aligned,
                        const Eigen::VectorXd& cross);

/// Column t of `samples` (as in AlignmentData) aligned: n values. Saturated samples are missing.
class Aligner {
 public:
  explicit Aligner(const Alignment& alignment);
  void column(const Eigen::MatrixXd& samples, Eigen::Index t, Eigen::VectorXd& out) const;
  /// Makes samples at their limits missing.
  void clip(Eigen::MatrixXd& samples) const;

 private:
  const Alignment* alignment_;
  std::vector<DelayTaps> taps_;
};

}  // namespace libchar::fusion
