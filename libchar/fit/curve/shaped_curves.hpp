#pragma once
// Curves of a fit with its shape: what the noise terms give once a filter and what lies outside the band are on top.

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

namespace detail {
/// Two-sided density of the noise terms and processes of the fit, without its shape and without rounding.
double unshaped_density(const NoiseFit& fit, double frequency_hz, double dt_s);
}  // namespace detail

/// Two-sided density of the fit at a frequency, 0 < f <= 1/(2 dt).
double shaped_density(const NoiseFit& fit, double frequency_hz, double dt_s);

/// Allan variance of the fit at averaging factor m.
double shaped_allan_variance(const NoiseFit& fit, double m, double dt_s);

/// Fills edf, intervals and reliability of every point (allan/confidence.cpp). A Gauss-Markov process counts as the
/// power law that its Allan curve is nearest to at each averaging time.
void add_fit_intervals(AllanCurve& curve, const NoiseFit& fit);

/// Allan variance of the Gauss-Markov process of the fit alone; 0 when it has none.
double process_allan_variance(const NoiseFit& fit, double m, double dt_s);

/// Variance by which the noise alone moves the mean of the record: the Allan variance at its length.
double mean_noise_variance(const NoiseFit& fit);

/// Shortest averaging time of the curve from which on the shape changes the Allan variance by less than a hundredth:
/// the terms alone are the whole curve there. 0 without a shape.
double plain_from_s(const NoiseFit& fit, const AllanCurve& curve);

}  // namespace libchar
