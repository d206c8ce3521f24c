#pragma once
// Before fusion: what makes sensors of one quantity differ that is no noise, and how to take it out.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace libchar::fusion {

/// How a sample between two instants is read. `sinc`: 24 taps, Kaiser window 8, within 1e-4 of the
/// amplitude up to 0.37 of the rate. `cubic`: 4 taps (Lagrange), within 1e-2 up to 0.12 of the rate;
/// it damps what is faster, most at half a sample, and aliased vibration with it.
enum class Interpolation { sinc, cubic };

struct AlignmentOptions {
  bool delay = true, bias = true, gain = true, misalignment = true;
  Interpolation interpolation = Interpolation::sinc;
};

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

/// What is learnt from: rows of consecutive instants, in one or several stretches.
struct AlignmentData {
  /// n rows of one quantity, then n rows a further axis (the same sensors in the same order).
  Eigen::MatrixXd samples;
  Eigen::Index channels = 0;
  Eigen::RowVectorXd truth;          ///< empty: blind, the mean of the channels is the truth
  std::vector<Eigen::Index> starts;  ///< first column of each stretch
};

/// Instants that the interpolation looks at on either side, a delay of at most kMostDelay included.
inline constexpr double kMostDelay = 8;
inline constexpr Eigen::Index kAlignmentMargin = 21;

/// Blind: sum of delays, of biases and of gains zero. Throws Error(numeric) when fewer than two
/// channels (taught: one) have samples, or when there are fewer than 64 instants.
Alignment learn_alignment(const AlignmentData& data, const AlignmentOptions& options);

/// Weights of the instants floor(delay) + first … of a sample read `delay` instants later.
struct DelayTaps {
  DelayTaps(double delay, Interpolation interpolation);
  /// y(t + delay), of `size` values. Where a tap is missing: linear between its neighbours, NaN
  /// where one of these is missing; `strict`: NaN.
  double at(const double* y,
            Eigen::Index stride,
            Eigen::Index size,
            Eigen::Index t,
            bool strict = false) const;
  std::vector<double> weights;
  Eigen::Index first = 0, floor = 0;
  double fraction = 0;
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
