#pragma once
// How noisy each sensor is from sample to sample, told from the sensors alone: to see on another log
// whether what was learnt still fits.
//
//   d_k = y_k - y_{k-1},  e = M d,  M = I - H (H'H)^-1 H':  E e_i^2 / 2 = sum_j M_ij^2 v_j
// solved for v (MINQUE with equal weights; Rao 1971). Differences leave offsets and slow drift out; the
// median over stretches leaves bursts of motion and faults out.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"

namespace libchar {

/// ln of a sensor's noise variance from sample to sample, and the standard error of it.
struct StepNoise {
  double log_variance = 0, error = 0;
};

/// Accumulates over consecutive instants; memory does not grow with their number.
class StepNoiseMeter {
 public:
  /// `h`: a row a sensor; `instants`: how many will come, for the length of the stretches.
  StepNoiseMeter(const Eigen::MatrixXd& h, std::int64_t instants);
  /// A column an instant, a row a sensor; instants with a missing sample are left out.
  void push(const Eigen::MatrixXd& samples);
  /// Of each sensor, none where it cannot be told; all alike when only their sum can (two sensors).
  /// Empty: too few instants.
  std::vector<std::optional<StepNoise>> result() const;
  /// A sensor that is noisier before or behind a place in the run.
  struct Change {
    std::size_t sensor = 0;
    double times = 1;     ///< the deviation behind it over that before
    bool least = false;   ///< the smaller one is not resolved: it is as much at least
    std::int64_t at = 0;  ///< instant
  };
  /// Beyond doubt, and by more than the input moves otherwise there: motion that sensors follow differently is no
  /// noise.
  std::vector<Change> changes() const;
  /// Each sensor's own can be told.
  bool identifiable() const { return inverse_.has_value() || many_alike_; }

 private:
  void close();
  struct Split {
    double before = 0, behind = 0, beyond = 0;  // medians, and their difference in standard errors
    double error = 0;                           // of the difference
  };
  std::size_t step_place(Eigen::Index row) const;
  Split split(Eigen::Index row, std::size_t at) const;
  Eigen::VectorXd solved(const Eigen::VectorXd& squares) const;

  Eigen::MatrixXd residual_;                // M; empty where many_alike_
  bool one_input_alike_;                    // one input seen alike by all: M d = d - mean
  bool many_alike_;                         // one_input_alike_, and so many sensors that the inverse is not written out
  std::optional<Eigen::MatrixXd> inverse_;  // of M o M
  double trace_ = 0;
  std::int64_t each_, now_ = 0, pairs_ = 0;
  Eigen::VectorXd last_, squares_, e_;
  bool has_last_ = false;
  std::vector<Eigen::VectorXd> stretches_;  // v of each sensor, and the mean square of the mean step
  std::vector<std::int64_t> ends_;          // instants
  double moves_ = 0;
};

/// What differs between here and where it was learnt, beyond doubt (six standard errors: below 1e-4 a
/// sensor and log for noise that is the same) and by more than a quarter of the deviation.
void warn_of_noise(const std::vector<std::string>& names, const std::vector<std::optional<StepNoise>>& learnt,
                   const std::vector<std::optional<StepNoise>>& here, Findings& warnings);

}  // namespace libchar
