#pragma once
// Estimators that other tools use, written anew from their descriptions and not from their code.

#include "libchar/benchmark/detail/estimators.hpp"

namespace libchar {

/// IEEE Std 952-1997, annex C: read off the curve, by the local slope.
NoiseEstimate read_off(std::span<const double> record, double rate_hz, const TermSet& terms);
/// Unweighted least squares on ln variance of the terms white, flicker and walk.
NoiseEstimate log_log(std::span<const double> record, double rate_hz, const TermSet& terms);
/// As nmayorov's script: sum of (model / variance - 1)^2 over coefficients >= 0, at 100 logarithmic strides up to N/10.
NoiseEstimate relative_least_squares(std::span<const double> record,
                                     double rate_hz,
                                     const TermSet& terms);
/// imu_utils: overlapping Allan variances at 100 logarithmic strides up to the largest power of two
/// below N/2, least squares on their log10 with equal weights, five squared coefficients (2 ln 2/pi
/// B^2 for flicker). Its objective is minimised from four starts around the third, so that it is
/// compared and not an optimizer.
NoiseEstimate imu_utils(std::span<const double> record, double rate_hz, const TermSet& terms);
/// allan_variance_ros: averages of 0.1 s, 0.2 s … 999.9 s side by side without overlap. N: mean of
/// ln sigma sqrt(tau) for tau < 10 s; K: sqrt 3 times the geometric mean of sigma/sqrt(tau) over
/// all periods; B: the lowest sigma.
NoiseEstimate allan_variance_ros(std::span<const double> record,
                                 double rate_hz,
                                 const TermSet& terms);

}  // namespace libchar
