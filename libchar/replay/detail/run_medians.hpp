#pragma once
// Weights and variances of a run: medians over time, since at its last instant sensors may be missing.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace libchar {

/// Notes are taken behind instants that do not depend on the blocks in which the run is read.
class RunMedians {
 public:
  /// Instants from `done` on until the next note is due.
  std::int64_t until_next(std::int64_t done) const { return every_ - done % every_; }
  void set_length(std::int64_t instants);
  /// After an instant whose notes are due.
  void note(const std::optional<Eigen::MatrixXd>& weights, const std::optional<Eigen::VectorXd>& variances);
  /// In the place of the values at the end; untouched where nothing was noted. Weights keep the sum that they have at
  /// most instants.
  void take(std::vector<double>& weights, std::vector<double>& variances) const;

 private:
  std::int64_t every_ = 1;
  std::vector<std::vector<double>> weights_, variances_;  // a series a sensor
};

}  // namespace libchar
