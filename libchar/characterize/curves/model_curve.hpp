#pragma once
// What a fitted mixture predicts for the curves of the report, and the points at which its coefficients are read off.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/model/sensor_model.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

/// Deviation that the fit predicts at averaging factor m, with its low-pass if it has one; nothing for types other than
/// the (overlapping) Allan deviation, whose curves are the only ones we have in exact form.
std::optional<double> model_deviation(const NoiseFit& fit, DeviationType type, double m, double dt_s);

/// Where the deviation of another stretch of the record, or of another recording of the sensor, is expected (95 %,
/// without the scatter of a measured curve). Follows from the intervals and limits of all terms, also unseen ones, and
/// from the differences between stretches of the record (fit/signs/stationarity.hpp). Nothing where `model_deviation`
/// gives nothing.
std::optional<Interval> model_interval(const NoiseFit& fit, DeviationType type, double m, double dt_s);

/// The fit's spectrum in the sides and scaling of `spectrum` at its bin i; nothing at f <= 0 or for a vanishing model.
std::optional<double> model_spectrum(const NoiseFit& fit, const Spectrum& spectrum, double frequency_hz);

/// A two-sided density in the sides and scaling of `spectrum`.
double scaled_density(const Spectrum& spectrum, double two_sided_density);

/// Point at which a coefficient is read off the Allan curve [RV Fig. 1.9].
struct ReadOff {
  Term term = Term::white;
  double tau_s = 1;
  double deviation = 0;
  std::string label;  ///< "N at 1 s", "0.664·B", "K at 3 s"
};
std::vector<ReadOff> read_off_points(const NoiseFit& fit, const AllanCurve& curve);

/// A term's asymptote on logarithmic axes: a straight line between two points, a decade beyond the curve on both sides.
struct Asymptote {
  Term term = Term::white;
  std::array<double, 2> x{}, y{};
};
/// For the types whose asymptotes these are: the (overlapping) Allan deviation.
std::vector<Asymptote> allan_asymptotes(const NoiseFit& fit, const AllanCurve& curve);
std::vector<Asymptote> spectrum_asymptotes(const NoiseFit& fit, const Spectrum& spectrum);

/// Lowest reliable point of a curve, if there is one.
const AllanPoint* allan_minimum(const AllanCurve& curve);

}  // namespace libchar

// The Allan curve that a sensor model implies: that of a fit with its coefficients.

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
