#pragma once
// Which sensors are wrong? The largest set that is consistent with one input over a window: for a set
// F of suspects that may say anything, what is left over of the others' means and slopes,
//
//   C(F) = 1/2 min_x sum_{i not in F} w_i (a_i - h_i x)^2  (means)  + the same of slopes  + c |F|
//
// (-log likelihood and a prior of e^-c a fault). All F up to half of the sensors are tried; only suspects with the most
// evidence against them where there are many. Sets whose cost is within `kDoubt` of the best explain the window as
// well: who is in all of them is wrong for certain, and when none is, the split is ambiguous (three against three).

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace libchar::fusion {

/// What a window says of one sensor.
struct WindowEvidence {
  double samples = 0;
  double mean = 0, mean_weight = 0;    ///< of the residual; 1 / variance
  double slope = 0, slope_weight = 0;  ///< of the residual on the input
  double suspicion = 0;                ///< evidence against it
};

struct Isolation {
  std::uint64_t best = 0;     ///< sensors of the cheapest set, bit by bit
  std::uint64_t certain = 0;  ///< those in every set that is nearly as cheap
  std::uint64_t other = 0;    ///< the cheapest set without a sensor in common with `best`
  double other_cost = 0;      ///< infinite: none
  double cost = 0, cost_of_none = 0;
  double misfit = 0, freedom = 0;  ///< chi square of the healthy ones, and its degrees of freedom
  bool consistent() const;
};

class FaultIsolation {
 public:
  FaultIsolation(const Eigen::MatrixXd& h, std::size_t sensors);
  static constexpr double kPrice = 8, kDoubt = 5;
  static constexpr int kMostSuspects = 10;
  /// Sensors named in `index` (m of them); positions in it are the bits of the result.
  Isolation isolate(const std::vector<WindowEvidence>& evidence, const int* index, int m);

 private:
  struct Sums;
  void add(Sums& sums, const WindowEvidence& e, int sensor) const;
  double left_over(const Sums& sums) const;

  Eigen::MatrixXd h_;
  int inputs_;
  std::vector<int> suspects_;  // positions, the most suspicious first
  struct Tried {
    double cost, misfit;
    std::uint64_t set;
  };
  std::vector<Tried> tried_;
};

}  // namespace libchar::fusion
