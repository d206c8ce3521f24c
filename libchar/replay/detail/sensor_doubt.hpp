#pragma once
// How far an estimate is off because sensors read otherwise than they were learnt to: with e_i what sensor i reads
// beyond its usual offset and gain against the median u of all (reading_meter.hpp), a sensor is in doubt while the
// running mean of e_i or of e_i² over 32 instants is beyond what is usual. While one is, the running mean of
// (estimate - u)² is added to the variance: the median does not follow a single sensor.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "libchar/replay/fusion_file.hpp"

namespace libchar::detail {

class SensorDoubt {
 public:
  /// As learnt, a sensor a row; that of a sensor without a reading is never in doubt.
  explicit SensorDoubt(std::vector<std::optional<LearntSensor::Reading>> learnt);
  /// The extra variance of each instant, and 0 where no sensor is in doubt. `estimates`: one for each column.
  const std::vector<double>& push(const Eigen::MatrixXd& samples, const Eigen::VectorXd& estimates);

 private:
  double instant(const Eigen::MatrixXd& samples, Eigen::Index at, double estimate);

  std::vector<std::optional<LearntSensor::Reading>> learnt_;
  std::vector<double> mean_, square_, sorted_, extra_;
  double away_ = 0;  // running mean of (estimate - u)²
};

}  // namespace libchar::detail
