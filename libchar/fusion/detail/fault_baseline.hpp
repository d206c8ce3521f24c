#pragma once
// What a healthy sensor's residual is: a slow mean that follows bias, gain and delay, and what of it
// the memory has not learnt yet.
//
//   e = b + g x + d dx + noise of variance s,   x: fused input less its slow mean, dx: its last step
//   S = s + B + G x^2 + D dx^2,  z = e / sqrt(S)      (B, G, D: how well b, g, d are known)
//   k = B / S,  b <- b + k e,  B <- max(B (1 - k), s / N)      and so for g with x, d with dx
//
// Recursive least squares with the covariance kept diagonal (x is centred and dx nearly orthogonal to
// it) and a memory of N samples, each sensor counting its own. z is white with deviation one while the
// sensor stays as it was, though its gain be 1 % off and its clock half a sample: what alarms is a
// change. Where z is not white all the same (motion that the others see differently), the long-run
// variance of blocks says by how much:
//
//   l_bias = mean (sum z)^2 / n,   l_gain = mean (sum x z)^2 / sum x^2,   l_noise = mean (sum z^2 - n)^2 / 2n
//
// and the evidence of the bank is divided by it. Where most sensors are off at once (a motion that was not
// there before), the median over the sensors of their z^2 in the last instants says by how much residuals
// are larger than expected: all z^2 are divided by it (`excess`).

#include <cstdint>
#include <vector>

#include "libchar/fusion/detail/cusum_bank.hpp"

namespace libchar::fusion {

struct FaultBaseline {
  explicit FaultBaseline(std::size_t sensors);

  std::size_t n, padded;
  // By sensor, padded with zeros.
  std::vector<double> here;                 ///< 1: takes part in this instant
  std::vector<double> armed;                ///< 1: and may be judged
  std::vector<double> learns;               ///< 1: and its mean may follow
  std::vector<double> f;                    ///< what the others and it say its sample should be
  std::vector<double> mean_f, last_f;       ///< slow mean, and that of the last instant
  std::vector<double> had_f;                ///< 1: the last instant had one
  std::vector<double> x, dx;                ///< of this instant
  std::vector<double> square_x, square_dx;  ///< slow mean squares
  std::vector<double> bias, gain, delay, bias_var, gain_var, delay_var;
  std::vector<double> bias_floor, gain_floor, delay_floor;
  std::vector<double> y;              ///< sample, then less its slow mean
  std::vector<double> e, s, root, z;  ///< residual and its variance, 1 / sqrt(S), e / sqrt(S)
  std::vector<double> count;          ///< of own samples
  std::vector<double> unit_x;         ///< 1 / deviation of x
  std::vector<double> start_margin;   ///< variances are taken for so many times larger
  std::vector<double> long_bias, long_gain, long_noise;      ///< long-run variance ratios
  std::vector<double> scale_bias, scale_gain, scale_noise;   ///< 1 / sqrt of those believed
  std::vector<double> sum_z, sum_xz, sum_xx, sum_zz, sum_n;  ///< of the block
  std::vector<double> blocks;
  std::vector<double> recent;  ///< mean of z^2 over the last kRecent samples
  double excess = 1;           ///< median of those, where it is clearly above one

  /// Memory in samples; x and dx have shorter ones.
  static constexpr double kMemory = 20000, kMeanMemory = 1000;
  static constexpr double kRecent = 200;
  static constexpr int kBlock = 512;

  /// f, here and y → x, dx and y less its slow mean.
  void predict();
  /// e, s → z and the input of the bank.
  void standardise(CusumSample& sample);
  /// b, g, d follow z.
  void learn();
  /// `excess` from the m sensors in use; scratch has room for them.
  void find_excess(const int* index, int m, std::vector<double>& scratch);
  /// What changes slowly: floors, units, by how much variances at the start are widened.
  void renew(double count_memory);
  /// The end of a block: long-run variances. `trusted`: the record begins without faults.
  void end_block(bool trusted, const std::vector<double>& tops, double frozen);
  void clear_block();
  /// What was learnt of the long run while the means were still wrong is forgotten.
  /// `trusted`: they are one until shown otherwise. Otherwise they are taken for large until shown otherwise:
  /// only gross faults are judged at first.
  void forget_blocks(bool trusted);
};

}  // namespace libchar::fusion
