#pragma once
// Units of sensor channels: what a unit text means, and the units in which each field quotes noise.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/enum_table.hpp"

namespace libchar {

enum class Quantity {
  angular_rate,
  acceleration,
  magnetic_field,
  pressure,
  temperature,
  voltage,
  angle,
  time,
  frequency,
  concentration,
  ratio
};
template <>
inline constexpr auto enum_table<Quantity> = enum_words<
    Quantity,
    "angular_rate acceleration magnetic_field pressure temperature voltage angle time frequency concentration ratio">;

struct Unit {
  std::string symbol;  ///< canonical spelling, e.g. "deg/s"
  Quantity quantity = Quantity::ratio;
  /// multiply by this to get rad/s, m/s^2, T, Pa, K, V, rad, s, Hz (differences; offsets are ignored)
  double to_si = 1;

  /// What a sample (not a difference) in `from` is multiplied by to be one in `to`; 1 where one of them says nothing.
  /// Nothing where they are of two quantities, or where one is not known. Nothing also where no factor converts them: K
  /// and °C have different zeros, ppm is a share and µg/m³ is not.
  static std::optional<double> sample_factor(std::string_view from, std::string_view to);
};

/// Reads "deg/s", "°/s", "dps", "rad s^-1", "m/s^2", "m s^-2", "g", "mg", "uT", "degC"… with case and blanks as they
/// are written them; nothing for an unknown text. A numeric factor in front ("1/16.4 deg/s") is part of the unit.
std::optional<Unit> find_unit(std::string_view text);

/// What a number in `from` is multiplied by to be one in `to`: 1 where either is not known; nothing where they
/// are of two quantities.
std::optional<double> unit_factor(std::string_view from, std::string_view to);

/// What a unit alone leaves open: the sides of a density; or that it is not the term but the lowest Allan deviation of
/// it.
enum class Reading { plain, one_sided, two_sided, floor };
template <>
inline constexpr auto enum_table<Reading> = std::to_array<EnumWord<Reading>>({{Reading::plain, ""},
                                                                              {Reading::one_sided, "one-sided"},
                                                                              {Reading::two_sided, "two-sided"},
                                                                              {Reading::floor, "floor"}});

/// One way in which the field says a noise term.
struct HabitualValue {
  double factor = 1;   ///< multiply the coefficient in the channel's own unit by this
  std::string symbol;  ///< "deg/√h", "µg/√Hz", "deg/h"…
  std::string name;    ///< "angle random walk", "bias instability B", "noise density"…
  Reading reading = Reading::plain;
};

/// The habitual units of a term ("white_noise", "bias_instability", "random_walk", "quantization", "rate_ramp") for a
/// channel in `unit`; empty when the unit is unknown or the field has no habit.
std::vector<HabitualValue> habitual_units(std::string_view term, std::string_view unit);

/// Unit text of a term's coefficient for a channel unit U: "U·√s" or "U/√Hz" for white noise, U, "U/√s", "U·s", "U/s".
std::string term_unit(std::string_view term, std::string_view unit);

/// For readers: "U" where no unit is stated, "" for a ratio ("1"), else the unit; and the same of a term's coefficient:
/// "√s", "1/√s".
std::string shown_unit(std::string_view unit);
std::string shown_term_unit(std::string_view term, std::string_view unit);

/// "0.05 deg/s", "1/16.4 deg/s", "3.33 mg": a number before a unit, which is the value of one count.
struct CountUnit {
  double factor = 1;
  std::string unit;  ///< as written after the number
};
std::optional<CountUnit> count_unit(std::string_view text);

/// "1/16.4" or "0.05"; nothing when it is not a number, or zero.
std::optional<double> parse_factor(std::string_view text);

/// Is it the unit of numbers without one ("1", "-", "none"), which is not printed?
bool dimensionless(std::string_view unit);

namespace detail {
/// What differences of samples per second are in: of a time the fractional frequency of a clock, "1".
struct DifferencedUnit {
  std::string unit;
  double factor = 1;  ///< of a difference per second
};
DifferencedUnit differenced_unit(const std::string& unit);
}  // namespace detail

}  // namespace libchar
