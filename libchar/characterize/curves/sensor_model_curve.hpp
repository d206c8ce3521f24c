#pragma once
// The Allan curve that a sensor model implies: that of a fit with its coefficients.

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar::detail {

/// The noise of a model as a fit would have found it.
NoiseFit sensor_model_fit(const SensorModel& model);

/// Averaging times that a model is shown for: its sampling interval, and the longest.
Interval sensor_model_times(const SensorModel& model);

/// `low` to `high`, twenty a decade, evenly on a logarithmic axis.
std::vector<double> even_on_log(double low, double high);

/// At twenty averaging times a decade; with an interval where the coefficients have one. Without a unit factor.
AllanCurve sensor_model_curve(const SensorModel& model, const NoiseFit& fit);

}  // namespace libchar::detail
