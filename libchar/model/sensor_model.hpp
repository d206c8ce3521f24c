#pragma once
// A sensor model: what is needed to simulate one sensor (design.md 4), and where each number came from.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libchar/fit/noise_fit.hpp"

namespace libchar {

struct SensorModel {
  std::string channel;
  std::string unit;
  double rate_hz = 0;
  std::array<Coefficient, kTerms> noise;      ///< status, value, 95 % interval of the five terms
  std::optional<double> bandwidth_hz;         ///< first-order low-pass, when the fit needed one
  std::optional<double> resolution;           ///< quantization step of the output (LSB)
  std::optional<double> saturation_low, saturation_high;  ///< when the recording reached them
  double mean = 0;                            ///< of the recording, removed before analysis: contains the true input at rest
  double tau_min_s = 0, tau_max_s = 0;        ///< range of averaging times that the coefficients were fitted on
  std::string obtained;                       ///< "fit of a recording", "fit of an Allan curve", "data sheet"
  std::string method;
  std::string recording_file, recording_sha256;
  double duration_s = 0;
  std::vector<std::string> remarks;
};

}  // namespace libchar
