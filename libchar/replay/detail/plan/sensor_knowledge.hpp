#pragma once
// What is found out about the sensors before the plan: offsets and noise levels.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/replay/common_errors.hpp"
#include "libchar/replay/detail/align/instants.hpp"

namespace libchar {

/// What a stretch at rest tells about each sensor: its offset and the level of its noise.
///   offset   mean of the samples
///   noise    half the mean square of successive differences, the Allan variance at one sample: slow
///            drift hardly enters, a constant input not at all
class RestMeter {
 public:
  explicit RestMeter(std::size_t sensors) : sensors_(sensors) {}
  /// Consecutive instants, a column each; NaN = missing.
  void push(const Eigen::MatrixXd& samples);
  std::vector<double> means() const;            ///< 0 without a sample
  std::vector<double> noise_variances() const;  ///< NaN without a difference
  /// About the mean; NaN without two samples. Of filtered samples, which have no drift, and of
  /// which neighbours are alike.
  std::vector<double> variances() const;

 private:
  struct Sums {
    double origin = 0, sum = 0, squares = 0, differences = 0, last = 0;
    std::uint64_t samples = 0, pairs = 0;
    bool has_last = false;
  };
  std::vector<Sums> sensors_;
};

/// What was found out about each sensor before the plan.
struct SensorKnowledge {
  std::vector<double> offsets;
  detail::CommonErrors common;
  std::vector<double> noise_variances;     ///< NaN: not known
  std::vector<std::string> noise_sources;  ///< "the scene", "the models", "rest", ""
};

/// What the numbers of a sensor's model are multiplied by to be in the unit that its channel is recorded in. Throws
/// Error(usage) where it is of another quantity.
double model_factor(const Scene& scene, const Instants& instants, std::size_t sensor);

/// Measures the rest when the scene has one, and asks scene and models for noise levels.
SensorKnowledge know_sensors(const Scene& scene, const Instants& instants, Progress& progress);

}  // namespace libchar
