#pragma once
// What came after the M stretches of the past that look most like the last d instants predicts this one; a scalar
// Kalman update then weighs the prediction against the channels [RV 3.8; Hamilton, Berry, Sauer 2016]:
//   p   = prediction from the neighbours of (z_{k-d} … z_{k-1})       delay_search.hpp
//   P   = 1 / (1/Q + sum 1/v_i),   x = p + P sum (y_i - p)/v_i        information form
// z is the inverse-variance mean, v the noise variances, Q the variance of the prediction's error.
// Q is estimated from e = z - p, whose variance is Q + 1/sum(1/v_i), unless it is given. The
// prediction starts afresh from the past at each instant, so there is no transition factor F.

#include <array>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/delay_search.hpp"

namespace libchar::fusion {

inline constexpr std::array kKalmanTakensOptions{
    Option{"dimension", "samples", 6, 1, 64, "d: instants that the past is compared over", true},
    Option{"neighbours", "", 20, 1, 256, "M: stretches that predict", true},
    Option{"dictionary", "", 1000, 20, 1e6, "stretches that are kept; the oldest give way", true},
    Option{"theiler", "samples", 6, 1, 1e6,
           "a stretch that ends nearer to now than this predicts nothing: it is the same event", true},
    Option{"process_variance", "U^2", 0, 0, 1e300, "Q of the prediction; 0: estimated from its errors"},
    Option{"memory", "samples", 1000, 10, 1e9, "over which the errors tell Q"}};

/// Of a step: the search is nearly all of it.
inline double kalman_takens_cost_ns(const Settings& settings, std::string_view stretches) {
  return 500 + settings[stretches] * (0.3 + 0.15 * settings["dimension"]) + 30 * settings["neighbours"];
}

/// What both algorithms share: a series to look in and a Kalman update.
class KalmanTakensFilter {
 public:
  /// from_reference: the series is the reference of the learning window, else the channels' own past.
  KalmanTakensFilter(const Array& array, const Settings& settings, bool from_reference);
  void learn(double truth);
  void exchange(LearntExchange& with);
  std::size_t learnt_stretches() const;
  std::size_t neighbours() const { return neighbours_; }
  Estimate step(const Sample& y);
  double process_variance() const;
  void remark(Findings& warnings) const;

 private:
  double predict();
  void learn_error(double error, double variance);
  void remember(double z, bool measured);
  void append(double value);
  void widen_spread(double z);

  Eigen::VectorXd levels_, weights_;
  std::size_t dimension_, neighbours_, dictionary_, theiler_;
  bool from_reference_;
  double given_q_, least_q_ = 0, keep_;
  DelaySearch search_;
  std::vector<double> series_;  // room for twice as many: moved down only when full
  std::size_t first_ = 0, last_ = 0;
  std::vector<double> recent_;  // z of the last d instants, gaps filled with the estimate
  std::size_t heard_ = 0;       // instants in recent_, at most d
  double error_square_ = 0, error_weight_ = 0;
  double mean_ = 0, spread_ = 0, seen_ = 0;  // of z: what a prediction that knows nothing is worth
  double gap_variance_ = 0;                  // grown while no channel measures
};

struct KalmanTakens {
  static constexpr Description description{.name = "kalman-takens",
                                           .title = "Kalman-Takens on the channels' own past",
                                           .source = "[RV 3.8]; Hamilton, Berry, Sauer 2016",
                                           .complexity = "O(n + d m), m stretches kept",
                                           .needs = {.noise_levels = true, .accepts_missing = true}};
  static constexpr std::array options = kKalmanTakensOptions;
  KalmanTakens(const Array& array, const Settings& settings) : filter_(array, settings, false) {}
  static double cost_ns(const Array&, const Settings& settings) {
    return kalman_takens_cost_ns(settings, "dictionary");
  }
  Estimate step(const Sample& y) { return filter_.step(y); }
  void remarks(Findings& warnings) const { filter_.remark(warnings); }

 private:
  KalmanTakensFilter filter_;
};

struct KalmanTakensTaught {
  static constexpr Description description{.name = "kalman-takens-taught",
                                           .title = "Kalman-Takens on the reference of the learning window",
                                           .source = "[RV 3.8]; Hamilton, Berry, Sauer 2016",
                                           .complexity = "O(n + d m), m stretches kept",
                                           .needs = {.reference = true, .noise_levels = true, .accepts_missing = true},
                                           .learning_complexity = "O(1)"};
  static constexpr std::array options = kKalmanTakensOptions;
  KalmanTakensTaught(const Array& array, const Settings& settings) : filter_(array, settings, true) {}
  void learn(const Sample&, const Sample& truth) { filter_.learn(truth[0]); }
  /// No stretch of the past reaches over a gap.
  void skip(const Sample&) { filter_.learn(std::nan("")); }
  /// Throws Error(numeric): the learning window is too short for M neighbours.
  void finish_learning();
  void exchange(LearntExchange& with) { filter_.exchange(with); }
  Estimate step(const Sample& y) { return filter_.step(y); }
  void remarks(Findings& warnings) const { filter_.remark(warnings); }

 private:
  KalmanTakensFilter filter_;
};

}  // namespace libchar::fusion
