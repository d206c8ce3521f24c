#pragma once
// The four zone rules of a control chart: what each found, how often it would by chance, and whether that is an alarm.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "libchar/core/document/enum_table.hpp"

namespace libchar {

enum class ZoneRule : std::uint8_t {
  beyond_3_sigma,  ///< a value more than three sigma from the centre
  two_of_three,    ///< of three in a row two on one side, more than two sigma off
  four_of_five,    ///< of five in a row four on one side, more than one sigma off
  eight_in_a_row,  ///< on one side
};
template <>
inline constexpr auto enum_table<ZoneRule> =
    enum_words<ZoneRule>({{ZoneRule::beyond_3_sigma, "beyond_3_sigma"},
                          {ZoneRule::two_of_three, "two_of_three"},
                          {ZoneRule::four_of_five, "four_of_five"},
                          {ZoneRule::eight_in_a_row, "eight_in_a_row"}});
inline constexpr std::size_t kZoneRules = enum_table<ZoneRule>.size();

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

inline constexpr double kChartAlarm = 0.01;

/// `sigma` > 0 as of `control_chart`: estimated from as many values.
ZoneFindings zone_findings(std::span<const double> values, double centre, double sigma);

}  // namespace libchar
