#pragma once
// Measures what the disagreement of sensors is made of.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "libchar/fusion/error_budget.hpp"

namespace libchar::fusion {

/// Accumulates over consecutive instants; memory does not grow with their number.
class BudgetMeter {
 public:
  /// `instants`: how many will come, for the length of the batches. `with_truth`: columns have one.
  BudgetMeter(Eigen::Index channels, Eigen::Index axes, std::int64_t instants, bool with_truth);
  /// One instant: samples as recorded, with their delays alone taken out (`in_time`), aligned, the mean of each further
  /// axis, the truth (NaN when blind). An instant at which anything is missing is left out.
  void push(const Eigen::VectorXd& recorded, const Eigen::VectorXd& undelayed, const Eigen::VectorXd& aligned,
            const Eigen::VectorXd& cross, double truth);
  ErrorBudget result() const;

 private:
  struct Instant {
    Eigen::VectorXd recorded, undelayed, aligned, cross;
    double x = 0;
    bool complete = false;
  };
  struct Sums {                          // of one batch
    Eigen::MatrixXd regressors;          // Gram matrix of 1, x, c_k, dx
    Eigen::MatrixXd errors;              // regressors' errors, one column per channel and the mean
    Eigen::VectorXd squares, undelayed;  // of the errors
    Eigen::VectorXd rest, rest_slope;    // r^2, r^2 dx^2 of what is aligned
    double slope2 = 0, slope4 = 0, count = 0;
    double before = 0, after = 0;
  };
  void add(const Instant& before, const Instant& now, const Instant& after);
  Sums total(std::size_t without) const;
  Eigen::MatrixXd powers(const Sums& sums, Eigen::MatrixXd* loadings) const;

  Eigen::Index n_, axes_;
  std::int64_t batch_, seen_ = 0;
  bool with_truth_;
  Instant last_[2];
  double x0_ = kNoOrigin;
  Eigen::VectorXd c0_;
  std::vector<Sums> batches_;
  static constexpr double kNoOrigin = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace libchar::fusion
