#pragma once
// Without a reference: a network that predicts the baseline's estimate x_k from those before it, p_k, learnt from the
// baseline itself, and mixed with it:
//
//   z_k = x_k - g (x_k - p_k),   g = c / S,   S = E (x - p)^2,   c = E e (x - p), e the error of x
//
// With errors of white or any other colour the mean square error of z is V - c^2 / S, the least there is. c needs no
// truth: two halves of the array, a and b, have independent errors, so c_a = E (x_a - x_b)(x_a - p_a) and
// c_b = E (x_b - x_a)(x_b - p_b) are those of each half, w_a c_a and w_b c_b both that of x. The smaller of the two
// counts, less three standard errors: what both halves do not share (gain, delay) enters them with opposite signs.

#include <vector>

#include "libchar/fusion/detail/simplex/network_fit.hpp"
#include "libchar/fusion/fault_log.hpp"

namespace libchar::fusion {

class PastNetwork {
 public:
  explicit PastNetwork(std::uint64_t seed);

  /// An instant: the baseline's estimate and its variance, the estimates of both halves of the array and their shares
  /// of the weights (0: none). False: not to be given out, `reason()` says why.
  bool judge(double x, double variance, const double* half, const double* weight);
  double x() const { return z_; }
  double variance() const { return variance_; }
  HandOverReason reason() const { return reason_; }
  int fits() const { return fits_; }

  static constexpr std::size_t kInputs = 6, kHidden = 5, kRing = 1024;
  static constexpr std::size_t kRoom = 64;  // longest lag and one

 private:
  struct Series {
    double at(std::size_t back) const { return ring[(seen - 1 - back) % kRoom]; }
    void push(double value) {
      ring[seen % kRoom] = value;
      ++seen;
    }
    bool full() const { return seen >= kRoom; }
    double ring[kRoom] = {};
    std::size_t seen = 0;
  };
  struct Rows final : FitRows {
    double row(std::size_t k, double* input) const override;
    std::vector<double> values;  // of kRing instants, in order of time
  };
  struct Mean {
    void add(double value, double memory);
    double error(double memory) const;
    double mean = 0, square = 0, count = 0;
  };

  static void inputs_of(const Series& series, double* z);
  double predicted(const Series& series);
  void keep(double x);
  void adapt();
  bool pays(double variance);

  Series fused_, half_[2];
  Rows rows_;
  std::vector<double> recent_;  // ring of kRing
  std::size_t kept_ = 0, next_fit_ = kRing;
  NetworkFit fit_;
  FittedNetwork active_;
  int fits_ = 0;
  std::uint64_t seed_;
  Mean innovation_, fast_, shared_[2];
  double z_ = 0, variance_ = 0, gain_ = 0;
  bool leads_ = false;
  int calm_ = 0;
  HandOverReason reason_ = HandOverReason::no_gain;
};

}  // namespace libchar::fusion
