#pragma once
// What is known of an array of sensors, as numbers: the fusion floor knows nothing of logs and files.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace libchar::fusion {

/// Which channels a tilt filter reads.
struct TiltChannels {
  Eigen::Index gyroscope = 0;        ///< rate about the tilt axis, rad/s
  Eigen::Index accelerometer_x = 1;  ///< grows with sin(tilt)
  Eigen::Index accelerometer_z = 2;  ///< grows with cos(tilt)
};

/// A noise that is remembered for a while: sigma^2 exp(-|t| / tau).
struct RememberedNoise {
  double sigma = 0;  ///< U
  double tau_s = 0;
};

/// What a sensor's model says of its noise, in the unit of the samples.
struct NoiseModel {
  double white = 0;    ///< variance of a sample's white noise, U^2; above zero
  double flicker = 0;  ///< B, U: two-sided density B^2 / (2 pi f)
  double walk = 0;     ///< K, U/sqrt(s): K^2 / (2 pi f)^2
  std::vector<RememberedNoise> gauss_markov;
};

/// What is known of an array of sensors before its samples come.
struct Array {
  Eigen::Index channels = 0;  ///< n
  /// what the channels are called, for remarks; empty: 1, 2, …
  std::vector<std::string> names;
  /// H, n rows of r inputs; empty: one input seen equally by all (H = 1)
  Eigen::MatrixXd observation_matrix;
  /// variance of a sample's noise, channel by channel; empty: not known
  Eigen::VectorXd noise_levels;
  /// of each channel; empty: not known
  std::vector<NoiseModel> noise_models;
  double rate_hz = 0;  ///< 0: not known
  /// instants with a reference before the run (0: no learning window)
  std::int64_t learning_samples = 0;
  /// the first so many instants of the run are known to hold no fault
  std::int64_t fault_free_samples = 0;
  /// the reference covers the whole run: bounds and oracles may look at it
  bool reference_throughout = false;
  /// instants of the run at which a sensor fails or comes back
  std::vector<std::int64_t> section_starts;
  std::optional<TiltChannels> tilt;

  Eigen::Index inputs() const { return observation_matrix.size() == 0 ? 1 : observation_matrix.cols(); }  ///< r
  /// H as a matrix in any case.
  Eigen::MatrixXd h() const {
    return observation_matrix.size() == 0 ? Eigen::MatrixXd(Eigen::MatrixXd::Ones(channels, 1)) : observation_matrix;
  }
  /// One input, seen by every channel with gain one: means need no matrix.
  bool one_common_input() const {
    return observation_matrix.size() == 0 ||
           (observation_matrix.cols() == 1 && (observation_matrix.array() == 1).all());
  }
};

/// What a channel is called in remarks.
inline std::string channel_name(const std::vector<std::string>& names, std::size_t channel) {
  return channel < names.size() ? names[channel] : std::to_string(channel + 1);
}

}  // namespace libchar::fusion
