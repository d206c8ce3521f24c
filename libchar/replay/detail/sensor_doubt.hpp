#pragma once
// How far an estimate is off because sensors read otherwise than they were learnt to: with e_i what sensor i reads
// beyond its usual offset and gain against the median u of all (reading_meter.hpp), a sensor is in doubt while the
// running mean of e_i or of e_i^2 over 32 instants is beyond what is usual, and for 4096 more. While one is, that of
// (estimate - m)^2 over 8 instants is added to the variance, m the mean of what the sensors that are not in doubt say
// of u, by their usual scatter, and the variance is that of m at least. Where fewer than two are left m is the median
// if they only scatter, independently from instant to instant. If not, and of two sensors, m is what that one says of u
// which is furthest from the estimate: any may be right.

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <vector>

#include "libchar/replay/fusion_file.hpp"

namespace libchar::detail {

class SensorDoubt {
 public:
  /// As learnt, a sensor a row; that of a sensor without a reading is never in doubt.
  explicit SensorDoubt(std::vector<std::optional<LearntSensor::Reading>> learnt);
  /// What a variance is: `least` at least, and `more` of it. Both 0: no sensor is in doubt.
  struct Variance {
    double least = 0, more = 0;
    double of(double stated) const { return std::max(stated, least) + more; }
  };
  /// Of each instant. `estimates`: one for each column.
  const std::vector<Variance>& push(const Eigen::MatrixXd& samples, const Eigen::VectorXd& estimates);

 private:
  Variance instant(const Eigen::MatrixXd& samples, Eigen::Index at, double estimate);

  std::vector<std::optional<LearntSensor::Reading>> learnt_;
  std::vector<int> held_;
  int moved_ = 0;  // the same, of a sensor whose e_i are correlated
  std::vector<double> mean_, square_, product_, last_, sorted_;
  std::vector<Variance> out_;
  double away_ = 0;  // running mean of (estimate - m)²
};

}  // namespace libchar::detail
