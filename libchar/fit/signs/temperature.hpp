#pragma once
// What of a record is the temperature's doing: a polynomial of temperature behind a first-order lag, taken out before
// the noise is fitted. Theory and figures: docs/theory/events.md.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/fit/signs/event.hpp"

namespace libchar {

inline constexpr std::size_t kTemperatureOrders = 3;

/// The thermometer of a sensor: as many samples as the sensor's record, at the same instants. Missing ones (a slower
/// thermometer has many) are bridged by straight lines.
struct TemperatureRecord {
  std::string name;
  std::string unit;  ///< "" where none is stated
  std::vector<double> samples;
};

/// y(t) = sum_j coefficient[j-1] (T_lag(t) - mean)^j, lag dT_lag/dt = T - T_lag, T_lag = T at the first sample.
struct TemperatureEffect {
  std::string channel, unit;  ///< of the temperature
  int order = 0;              ///< of the polynomial; 0: not significant, and nothing is taken out
  double p = 1;               ///< probability of as much in a record that temperature does not move
  double mean = 0;            ///< of the temperature
  Interval range;             ///< of the temperature
  std::array<double, kTemperatureOrders> coefficient{};  ///< per K, K², K³ (of the unit above)
  double sd = 0;                                         ///< of the first one, the lag given
  Interval ci95;                                         ///< of the first one, the lag not given
  double lag_s = 0;
  Interval lag_ci95;  ///< upper end 0: the record sets none
  double gain = 0;    ///< 2 ln L that it brings
  double rms = 0;     ///< of what was taken out
  bool like_drift =
      false;             ///< a straight drift or a warm-up explains the record nearly as well: the record cannot tell
  Coefficients without;  ///< of the noise when temperature is left in

  /// The removed effect, about its mean: point i is at sample first + i * per_point.
  std::vector<double> value;
  double first = 0, per_point = 1;
  /// Degrees of freedom that it takes from the transform coefficient k = 1.. at [k-1].
  std::vector<double> leverage;
};

/// Throws Error(numeric) where it is constant, has fewer than eight values, or is missing over more than a tenth of the
/// record at once.
void check_temperature(const TemperatureRecord& temperature, double rate_hz);

/// Tested at 1 %: where temperature moves the record by no more than chance, `order` is 0. Throws as
/// `check_temperature` does, of the stretch where the record has samples.
TemperatureEffect find_temperature_effect(std::span<const double> record, double rate_hz,
                                          const TemperatureRecord& temperature);

namespace detail {
/// Of a channel and a thermometer by means of the same samples; none where the thermometer is constant. The effect has
/// no place in the record (`first`).
TemperatureEffect temperature_effect_of_means(const EventSeries& series, const EventSeries& temperature,
                                              const std::string& name, const std::string& unit);
}  // namespace detail

/// Takes it out of a record at its full rate (sign -1), or puts it in (+1).
void add_temperature_effect(const TemperatureEffect& effect, double sign, std::span<double> record);

/// "It moves with temperature (temp) by 0.0123 [0.0119, 0.0127] deg/s/K at 31.2 °C, with a lag of 2 min (80 s to 3 min)
/// and order 1…"
std::string temperature_sentence(const TemperatureEffect& effect, std::string_view unit);

}  // namespace libchar
