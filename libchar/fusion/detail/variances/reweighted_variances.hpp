#pragma once
// Recursive re-weighted MINQUE for one input seen by all channels alike: the noise variances of n
// channels without a reference.
//
//   p_i = (1/v_i) / sum_j 1/v_j,  x = sum p_i y_i,  r_i = y_i - x,  q_i = r_i^2 / v_i
//   (diag(1 - 2p) + p p' + lambda I) u = q - (1 - p),     v_i <- v_i (1 + a u_i),     a = 1 - gamma
//
// One scoring step of restricted maximum likelihood (Patterson & Thompson 1971; Rao 1971 for MINQUE) an instant: with
// equal p and lambda = 0 it is MINQUE with identity weights, at the true v it is as efficient as the full-record REML,
// in O(n). The matrix is the Fisher information of ln v; it is diagonal plus rank one, so it is solved by elimination,
// the channel with the largest p first.
//
// With a long memory the variances hardly move in an instant. The squares r_i^2 are then gathered,
// each with its gain a, and one step is taken for all of them when the gains sum to kRenewal (or
// another set of channels is in use): between two steps weights stand, and an instant costs little
// more than a weighted mean. At gamma <= 0.99 every instant is a step.
//
// lambda: where two channels carry all the weight, only the sum of their variances shows in the data and the matrix is
// nearly singular. The ridge leaves the fixed point where it is (E u = 0 at the true v) and makes the poorly seen
// directions slow instead of noisy: their relative standard deviation stays below sqrt(a / lambda). A channel that is
// far better than all others has a tenth of it: its weight p nears one, its information is (1 - p)^2, and a full ridge
// would keep the weights of the others at sqrt(lambda).
//
// The variance of x is stated as f + o^2 / (f + o), f = 1 / sum_j 1/v_j, o what the memory leaves open of the heaviest
// channel h: a standard deviation of its variance, sqrt(1 - gamma) / sum_{j != h} 1/v_j, times p_h^2.

#include <limits>
#include <vector>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

struct ReweightingOptions {
  double gamma = 0.999;      ///< memory: 1 / (1 - gamma) instants
  double damping = 10;       ///< lambda = damping x a
  double floor = 1e-4;       ///< of a variance, relative to the fused variance of the other channels
  double floor_largest = 0;  ///< of a variance, relative to the largest one
  /// 0: from the first instants, with a gain that falls as 2/k to 1 - gamma
  double start_variance = 0;
};

/// Part of the ridge that stays where one channel carries nearly all the weight.
inline constexpr double kLeastRidge = 0.1;

/// Variances, weights and residuals of n channels, some of which may sit out an instant.
class ReweightedVariances {
 public:
  ReweightedVariances(std::size_t n, const ReweightingOptions& options);

  /// Fused value of the m channels named in `index`, rising (nullptr: all); residuals stand in
  /// `residuals()` until the next call. The samples must be finite.
  double fuse(const double* y, const int* index, int m);
  /// Learns from the residuals of the last `fuse`.
  void update() {
    if (m_ < 3) return;  // two channels tell the sum of their variances only
    if (!started_) {
      start(y_);
      return;
    }
    const double a = gain();
    gather(a);
    if (gathered_gain_ >= kRenewal || ++gathered_instants_ >= kMostGathered) renew(a);
  }

  /// Starts from these variances, as if they had been seen in `instants`.
  void begin(const double* variances, double instants);
  /// The gain falls again as it did after so many instants.
  void restart(double instants);
  /// From here on channel i has this variance.
  void assume(std::size_t i, double variance);

  /// Of the last `fuse`.
  Estimate estimate() const {
    return Estimate::scalar(x_, started_ ? fused_.stated : std::numeric_limits<double>::quiet_NaN());
  }
  /// Of a channel that was not in use: sample less fused value, and its variance.
  double innovation(std::size_t, double sample) const { return sample - x_; }
  double innovation_variance(std::size_t i) const { return v_[i] + fused_.variance; }
  std::size_t size() const { return v_.size(); }
  double variance(std::size_t i) const { return v_[i]; }
  /// By channel, of those in use in the last `fuse`.
  const double* residuals() const { return r_.data(); }
  /// Part of the variance of each channel in use that shows in its residual.
  const double* residual_variances() const { return shown_.data(); }
  /// A level below which a variance is rounding error.
  double rounding() const { return rounding_; }
  bool started() const { return started_; }
  const std::vector<double>& variances() const { return v_; }
  /// n x 1, zero for channels that are not in use.
  Eigen::MatrixXd weights() const;

  /// Relative standard deviation that the memory alone leaves in the worst-seen mixture of
  /// variances, and that mixture: above one third or so, the data do not tell these channels apart.
  /// All channels; for reports, not for every instant.
  double blindness(std::vector<double>& direction) const;

  /// Gain that is gathered before the variances are renewed: a hundredth of what they know.
  static constexpr double kRenewal = 0.0079;
  static constexpr int kMostGathered = 16;

 private:
  double median(const double* y);
  void start(const double* y);
  void start_from_pairs();
  void refine_start();
  bool all() const { return m_ == static_cast<int>(v_.size()); }
  /// Another set of channels: what was gathered belongs to the old one.
  void use(const int* index, int m);
  void weigh();
  double gain();
  void gather(double a);
  void renew(double a);
  template <bool kAll>
  double fuse_in_use(const double* y);
  /// The factors of the variances; returns the channel of the largest p.
  template <bool kAll>
  int solve(double lambda);
  template <bool kAll>
  void apply(int heaviest);

  ReweightingOptions options_;
  // All by channel.
  std::vector<double> v_, inverse_, r_;
  std::vector<double> p_;         // weights; zero where a channel is not in use
  std::vector<double> shown_;     // v - fused variance, where in use
  std::vector<double> gathered_;  // sum of gain x r^2 since the variances were renewed
  std::vector<double> b_, e_;     // right side, 1 / (1 - 2p + lambda)
  std::vector<int> index_;        // channels in use, rising: the first m_
  std::vector<double> sorted_;    // scratch of the start
  std::vector<int> usable_;       // as well
  std::vector<double> first_;     // samples of the first instants, NaN where a channel was not in use
  int m_ = 0;
  struct {
    double variance = 1;  // 1 / sum of the inverse variances in use
    double stated = 1;    // with what the memory leaves open of it
  } fused_;
  double x_ = 0, rounding_ = 0;
  double instants_ = 0;
  double gathered_gain_ = 0, last_gain_ = 0, gathered_rounding_ = 0;
  int gathered_instants_ = 0;
  int first_instants_ = 0;
  const double* y_ = nullptr;  // of the last `fuse`
  bool started_ = false;
};

}  // namespace libchar::fusion
