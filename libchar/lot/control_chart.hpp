#pragma once
// Individuals in the order in which they were made: does the process stay where it is?

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/random_effects.hpp"

namespace libchar {

// The four zone rules of a control chart: what each found, how often it would by chance, and whether that is an alarm.

enum class ZoneRule : std::uint8_t {
  beyond_3_sigma,  ///< a value more than three sigma from the centre
  two_of_three,    ///< of three in a row two on one side, more than two sigma off
  four_of_five,    ///< of five in a row four on one side, more than one sigma off
  eight_in_a_row,  ///< on one side
};
template <>
inline constexpr auto enum_table<ZoneRule> =
    enum_words<ZoneRule, "beyond_3_sigma two_of_three four_of_five eight_in_a_row">;
inline constexpr std::size_t kZoneRules = enum_table<ZoneRule>.size();

namespace detail {
inline constexpr double kChartAlarm = 0.01;  ///< of a process that stays where it is
}

/// Signals that follow each other without a value between them are one.
struct ZoneFinding {
  std::size_t signals = 0;
  double by_chance = 0;  ///< expected of a normal process that stays where it is
  double p = 1;          ///< of as many there, or one as far off or as long
  bool alarm = false;    ///< else a signal is a hint
};

struct ZoneFindings {
  std::array<ZoneFinding, kZoneRules> rule;
  double any_by_chance = 0;  ///< probability that a process that stays where it is shows any signal
  bool alarm = false;        ///< of any rule: in at most 1 % of such processes

  const ZoneFinding& of(ZoneRule one) const { return rule[static_cast<std::size_t>(one)]; }
};

/// `sigma` > 0 as of `control_chart`: estimated from as many values.
ZoneFindings zone_findings(std::span<const double> values, double centre, double sigma);

/// Some values that follow each other: one, where there are few of them.
struct ChartPoint {
  std::size_t first = 0, count = 1;
  double mean = 0, low = 0, high = 0;
};

struct ChartValue {
  std::size_t index = 0;
  double value = 0;
};

struct ControlChart {
  double centre = 0;
  double sigma = 0;                ///< from value to value: mean moving range over 1.128
  Interval limits;                 ///< centre ± 3 sigma
  std::vector<ChartPoint> points;  ///< at most kChartPoints
  std::vector<ChartValue> beyond;  ///< outside of the limits, in order
  ZoneFindings zones;              ///< nothing where sigma is zero
};

inline constexpr std::size_t kChartPoints = 300;
/// Fewer values have no chart.
inline constexpr std::size_t kLeastForChart = 8;

/// At least two values.
ControlChart control_chart(std::span<const double> values);

// How many values lie where, and how well the devices of a lot keep a limit.

struct Capability {
  double most = 0;   ///< the limit, in the unit of the values
  std::string text;  ///< as in its file
  std::size_t pass = 0, fail = 0,
              not_decided = 0;  ///< devices; each by the interval of its own value
  /// (limit - mean) / (3 spread) in logarithms, by the devices' own mean and spread; infinite: no spread is seen
  std::optional<double> ppk;
  Interval ppk_ci95;
  /// The same with the deviation from one device to the next of the control chart, which holds the uncertainty of each
  /// as well.
  std::optional<double> cpk;
  double above = 0;  ///< share of devices above the limit that a normal distribution with that ppk has
};

/// Fills ppk, its interval and `above`. `limit` as what `effects` is of.
void add_ppk(const RandomEffects& effects, double limit, Capability& out);

/// Bins of one width; distant values are in `below` and `above`, so that one wild value does not squeeze all others
/// into a bin.
struct Histogram {
  double low = 0, step = 1;          ///< bin k reaches from low + k step to the next
  std::vector<std::uint64_t> count;  ///< empty: of no values
  std::uint64_t below = 0, above = 0;
};

/// Width by Freedman & Diaconis, 2 (interquartile range) / n^(1/3); 1 to 60 bins within eight robust deviations of the
/// median.
Histogram histogram_of(std::span<const double> values);

}  // namespace libchar
