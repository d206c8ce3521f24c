#pragma once
// Kalman-Takens as the listing of [RV 3.8] has it, for comparison:
//   query and dictionary from simple averages, the first `training` instants of the run
//   F = p / x_{k-1},  P- = F P F + Q,  P = 1/(1/P- + sum 1/v_i),  x = P (p/P- + sum y_i/v_i)
// F is no derivative and explodes where the last estimate is near zero; then P- is large and the channels alone decide,
// which does no harm. Two mends only: v is the noise variance (the listing takes the density, 623 times too small:
// option noise_scale) and a distance of zero does not divide.

#include <array>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/algorithms/kalman_takens.hpp"
#include "libchar/fusion/detail/delay_search.hpp"

namespace libchar::fusion {

struct KalmanTakensPublished {
  static constexpr Description description{.name = "kalman-takens-published",
                                           .title = "Kalman-Takens as published",
                                           .source = "[RV 3.8]",
                                           .complexity = "O(n + d m), m training instants",
                                           .needs = {.noise_levels = true},
                                           .as_published = true};
  static constexpr std::array options{
      Option{"dimension", "samples", 6, 1, 64, "d: instants that the past is compared over", true},
      Option{"neighbours", "", 20, 1, 256, "M: stretches that predict", true},
      Option{"training", "samples", 1000, 2, 1e6, "instants at the start whose averages are the dictionary", true},
      Option{"process_variance", "U^2", 0.01, 0, 1e300, "Q of the prediction"},
      Option{"start_variance", "U^2", 0.001, 0, 1e300, "P after the training"},
      Option{"noise_scale", "", 1, 1e-12, 1e12,
             "R over the noise variance; 1/623 is the spectral density that the listing takes"}};

  KalmanTakensPublished(const Array& array, const Settings& settings);
  static double cost_ns(const Array&, const Settings& settings) { return kalman_takens_cost_ns(settings, "training"); }
  Estimate step(const Sample& y);

 private:
  double mean_of(const Sample& y) const;

  Eigen::VectorXd levels_;
  double information_;
  std::size_t dimension_, training_;
  double q_, p_, x_ = 0;
  DelaySearch search_;
  std::vector<double> dictionary_, recent_;
};

}  // namespace libchar::fusion
