#pragma once
// What of a record is a mean and no noise: temperature, steps, a warm-up, a ramp. Taken out before the noise is fitted.

#include <optional>
#include <span>
#include <vector>

#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/fit/signs/events.hpp"

namespace libchar {

struct RecordMeans {
  std::vector<double> samples;  ///< the record without them; empty: nothing was found
  EventSearch search;
  bool events_taken = false;  ///< else they are too many or too alike, and stay
  std::optional<TemperatureEffect> temperature;
};

/// Looks for what `options` asks for, and for what a temperature does where one is given (else
/// null). `series` of the record, where it is there already.
RecordMeans without_means(std::span<const double> record, double rate_hz, const FitOptions& options,
                          const TemperatureRecord* temperature, const EventSeries* series = nullptr);

/// The same events of a series alone, without samples.
RecordMeans means_in(const EventSeries& series, const FitOptions& options);

/// What they take of the degree of freedom of each coefficient of the transform, k = 1.. at [k-1].
std::vector<double> spent_on(const RecordMeans& means);
/// That, for the bins.
void count_spent(std::span<const double> leverage, double duration_s, std::vector<PowerBin>& bins);

/// Into the fit of what is left: sentences, events, remedies.
void report_means(const RecordMeans& means, const FitOptions& options, NoiseFit& fit);

}  // namespace libchar
