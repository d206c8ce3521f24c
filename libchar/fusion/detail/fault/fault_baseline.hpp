#pragma once
// What a healthy sensor's residual is: a slow mean that follows bias, gain and delay, and what of it
// the memory has not learnt yet.
//
//   e = b + g x + d dx + noise of variance s,   x: fused input less its slow mean, dx: its last step
//   S = s + B + G x^2 + D dx^2,  z = e / sqrt(S)      (B, G, D: how well b, g, d are known)
//   k = B / S,  b <- b + k e,  B <- max(B (1 - k), s / N)      and so for g with x, d with dx
//
// Recursive least squares with the covariance kept diagonal (x is centred and dx nearly orthogonal to it) and a memory
// of N samples, each sensor counting its own. z is white with deviation one while the sensor stays as it was, though
// its gain be 1 % off and its clock half a sample: what alarms is a change. Where z is not white all the same (motion
// that the others see differently), the long-run variance of blocks says by how much:
//
//   l_bias = mean (sum z)^2 / n,   l_gain = mean (sum x z)^2 / sum x^2,   l_noise = mean (sum z^2 - n)^2 / 2n
//
// and the evidence of the bank is divided by it; for a gain the share 1 - 1/l_bias of the last mean of z is taken out
// of z first: half a period of x and a slow offset look like one. Tails heavier than Gauss's are cut where the bank's
// sums would not be worth their false alarms otherwise (`clip`). Where most sensors are off at once (a motion that was
// not there before), the median over the sensors of their z^2 in the last instants says by how much residuals
// are larger than expected: all z^2 are divided by it (`excess`).

#include <vector>

#include "libchar/fusion/detail/fault/cusum_bank.hpp"
#include "libchar/fusion/detail/fault/motion_level.hpp"

namespace libchar::fusion {

/// Values of one kind, a sensor each. Four sensors stand beside each other, kind after kind: one pass over
/// a group finds all that it needs at fixed distances.
class SensorColumn {
 public:
  SensorColumn(double* first, std::size_t stride, std::size_t padded)
      : first_(first), stride_(stride), padded_(padded) {}
  double& operator[](std::size_t i) { return first_[i / 4 * stride_ + i % 4]; }
  double operator[](std::size_t i) const { return first_[i / 4 * stride_ + i % 4]; }
  void fill(double value) {
    for (std::size_t i = 0; i < padded_; ++i) (*this)[i] = value;
  }
  void take(const SensorColumn& other) {
    for (std::size_t i = 0; i < padded_; ++i) (*this)[i] = other[i];
  }

 private:
  double* first_;
  std::size_t stride_, padded_;
};

struct FaultBaseline {
  explicit FaultBaseline(std::size_t sensors);
  FaultBaseline(const FaultBaseline&) = delete;  // columns point into `block`
  FaultBaseline& operator=(const FaultBaseline&) = delete;

  enum Kind : std::size_t {
    kHere,
    kArmed,
    kF,
    kMeanF,
    kLastF,
    kHadF,
    kX,
    kDx,
    kSquareX,
    kSquareDx,
    kBias,
    kGain,
    kDelay,
    kBiasVar,
    kGainVar,
    kDelayVar,
    kBiasFloor,
    kGainFloor,
    kDelayFloor,
    kE,
    kS,
    kRoot,
    kZ,
    kCount,
    kUnitX,
    kStartMargin,
    kScaleBias,
    kScaleGain,
    kScaleNoise,
    kSumZ,
    kSumXz,
    kSumXx,
    kSumZz,
    kSumN,
    kSumTail,
    kClip,
    kRecentSquare,
    kLevel,
    kMotion,
    kKinds
  };
  static constexpr double kMostDeviations = 1e6;
  static constexpr std::size_t kStride = 4 * kKinds;  ///< from a group of four sensors to the next

  std::size_t n, padded;
  std::vector<double> block;  ///< all columns; the sensors beyond n are zero
  // By sensor.
  SensorColumn here;                 ///< 1: takes part in this instant
  SensorColumn armed;                ///< 1: and may be judged
  SensorColumn f;                    ///< what the others and it say its sample should be
  SensorColumn mean_f, last_f;       ///< slow mean, and that of the last instant
  SensorColumn had_f;                ///< 1: the last instant had one
  SensorColumn x;                    ///< f less its slow mean
  SensorColumn square_x, square_dx;  ///< slow mean squares of x and of the last step of f
  SensorColumn bias, gain, delay, bias_var, gain_var, delay_var;
  SensorColumn bias_floor, gain_floor, delay_floor;
  SensorColumn e, s, z;                               ///< residual and its variance, e / sqrt(S)
  SensorColumn count;                                 ///< of own samples
  SensorColumn unit_x;                                ///< 1 / deviation of x
  SensorColumn start_margin;                          ///< variances are taken for so many times larger
  SensorColumn scale_bias, scale_gain, scale_noise;   ///< 1 / sqrt of the long-run ratios believed
  SensorColumn sum_z, sum_xz, sum_xx, sum_zz, sum_n;  ///< of the block
  SensorColumn sum_tail;                              ///< of the block: samples with |z| > kTail
  SensorColumn clip;                                  ///< what is beyond proves nothing more
  SensorColumn recent;                                ///< mean of z^2 over the last kRecent samples
  std::vector<double> y;                              ///< sample, then less its slow mean
  /// Of the blocks so far, a sensor each.
  struct LongRun {
    std::vector<double> bias, gain, noise;  ///< variance ratios
    std::vector<double> blocks;             ///< how many
    std::vector<double> tails, tails_of;    ///< samples with |z| > kTail, of so many
    double most_clip = kMostDeviations;     ///< where tails are not heavy
    MotionLevel motion;                     ///< variance by the size of the input
    explicit LongRun(std::size_t padded)
        : bias(padded, 1.0),
          gain(padded, 1.0),
          noise(padded, 1.0),
          blocks(padded, 0.0),
          tails(padded, 0.0),
          tails_of(padded, 0.0),
          motion(padded) {}
  } long_run;
  double excess = 1;  ///< median of `recent`, where it is clearly above one

  /// Memory in samples; x and dx have shorter ones.
  static constexpr double kMemory = 20000, kMeanMemory = 1000;
  static constexpr double kRecent = 200, kLevelMemory = 64;
  static constexpr int kBlock = 512;
  static constexpr int kLeastOfBlock = kBlock / 8;
  static constexpr double kTail = 4;

  /// f, here and y → x, dx and y less its slow mean.
  void predict();
  /// By how much the variance of a sensor differs at this input from what it is on average.
  double motion(std::size_t i) const { return block[i / 4 * kStride + 4 * kMotion + i % 4]; }
  double motion_at(std::size_t i, double input) const { return long_run.motion.at(i, input); }
  /// For the x of this instant.
  void find_motion();
  /// e, s → z and the input of the bank.
  void standardise(CusumSample& sample);
  /// b, g, d follow z, of those whose evidence (`tops`, padded) is not above `frozen`.
  void learn(const std::vector<double>& tops, double frozen);
  /// The same gates for the variances by the size of the input, and what they are from now on.
  void learn_motion(const std::vector<double>& tops, double frozen);
  void renew_motion(double samples);
  /// `excess` from the m sensors in use; scratch has room for them.
  void find_excess(const int* index, int m, std::vector<double>& scratch);
  /// What changes slowly: floors, units, by how much variances at the start are widened.
  void renew(double count_memory, std::vector<double>& scratch);
  /// The end of a block: long-run variances. `trusted`: the record begins without faults.
  void end_block(bool trusted, const std::vector<double>& tops, double frozen);
  void clear_block();
  /// An alarm was over at once: from here on no single sample of any sensor is worth one.
  void expect_outliers();
  bool expects_outliers() const { return long_run.most_clip < kMostDeviations; }
  /// What was learnt of the long run while the means were still wrong is forgotten. `trusted`: they are one until shown
  /// otherwise. Otherwise they are taken for large until shown otherwise: only gross faults are judged at first.
  void forget_blocks(bool trusted);

 private:
  SensorColumn column(Kind kind);
};

}  // namespace libchar::fusion
