#pragma once
// A first-order low-pass in front of the samples.

#include <optional>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

/// Power gain at frequency f of y_t = a y_{t-1} + (1-a) x_t, a = exp(-2 pi corner / rate), and its
/// derivative d ln gain / d ln corner.
struct LowPassGain {
  double gain = 1, log_slope = 0;
};
LowPassGain low_pass_gain(double frequency_hz, double corner_hz, double rate_hz);
/// The same averaged over a bin.
LowPassGain low_pass_gain(const PowerBin& bin, double corner_hz, double rate_hz);

/// The bins with their expectations multiplied by the gain.
std::vector<PowerBin> low_passed(std::vector<PowerBin> bins, double corner_hz, double rate_hz);

/// Best corner with all offered terms free, and the joint fit.
struct LowPassFit {
  double corner_hz = 0;
  double log_sd = 0;  ///< of ln corner, joint covariance
  double half_deviance = 0;
  Mixture theta{};
  Mixture log_theta_sd{};  ///< joint covariance, positive terms
};
std::optional<LowPassFit> fit_low_pass(const std::vector<PowerBin>& bins, double rate_hz,
                                       const std::array<bool, kTerms>& terms);

}  // namespace libchar
