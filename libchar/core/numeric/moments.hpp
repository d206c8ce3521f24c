#pragma once
// Mean, variance, skewness, kurtosis, extremes of a stream of samples; NaN is skipped and counted.

#include <cstdint>
#include <span>

namespace libchar {

/// Central moments merged block by block. Within a block of 4096 samples: sums about the block's mean. Between blocks:
///   M2 = M2a + M2b + d^2 na nb / n,   d = mean_b - mean_a      (Chan, Golub & LeVeque 1979; Pébay 2008 for M3, M4).
/// So an offset of 10⁹ standard deviations costs nothing. Results depend on the sequence only, not on how it is pushed.
/// Samples whose fourth powers a double does not hold are taken in a unit 2^exponent larger.
class Moments {
 public:
  void push(std::span<const double> samples);

  std::uint64_t count() const;        ///< samples that are not NaN
  std::uint64_t missing() const;      ///< NaN
  double mean() const;                ///< 0 when there is no sample
  double variance() const;            ///< divided by n - 1; 0 when n < 2; may be beyond a double
  double standard_deviation() const;  ///< never is
  double skewness() const;            ///< 0 for constant data
  double kurtosis() const;            ///< 3 for a Gaussian; 0 for constant data
  double minimum() const;             ///< +inf when there is no sample
  double maximum() const;             ///< -inf when there is no sample

 private:
  static constexpr int kBlock = 4096;
  struct Central {
    double n = 0, mean = 0 /* less origin_ */, m2 = 0, m3 = 0, m4 = 0;
    int exponent = 0;  // of the unit
  };
  Central of_block(const double* x, int n) const;
  Central of_block(const double* x, int n, double origin) const;
  static Central in_unit(const Central& c, int exponent);
  static Central merged(const Central& a, const Central& b);
  Central total() const;

  double origin_ = 0;  // the first sample
  bool started_ = false;
  Central done_;
  double pending_[kBlock];
  int pending_count_ = 0;
  std::uint64_t missing_ = 0;
  double minimum_ = __builtin_inf(), maximum_ = -__builtin_inf();
};

}  // namespace libchar
