#include "libchar/report/detail/replay_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"

namespace libchar {

std::string score_name(const ReplayResult& result) {
  return result.has_reference ? "RMSE" : "Leave-one-out RMS";
}

std::string usual_unit(const std::string& unit) {
  const auto known = find_unit(unit);
  return known && known->symbol != "1" ? std::string(known->symbol) : unit;
}

std::string score_unit(const ReplayResult& result) {
  return result.inputs.empty() ? "" : usual_unit(result.inputs[0].unit);
}

std::string with_unit(double value, int digits, const std::string& unit) {
  const std::string number = people(value, digits);
  return unit.empty() || !std::isfinite(value) ? number : number + " " + unit;
}

std::string people_percent(double share, int digits) {
  if (!std::isfinite(share)) return "–";
  const double percent = 100 * share;
  // A regret of 3e-7 is none: it would be written as a power of ten.
  if (std::fabs(percent) < 0.005) return "0.00 %";
  if (std::fabs(percent) >= 1000) return people(percent, 4) + " %";
  return fmt::format("{:.{}f} %", percent, std::fabs(percent) < 10 ? digits : digits > 1 ? 1 : 0);
}

std::string people_instant(double seconds) {
  return std::isfinite(seconds) ? significant(seconds, 8) + " s" : "–";
}

std::string people_stretch(double from_s, double to_s) {
  return people_instant(from_s) + " … " + (std::isfinite(to_s) ? people_instant(to_s) : "the end");
}

std::string people_interval(const Interval& interval, int digits) {
  if (!std::isfinite(interval.low) || !std::isfinite(interval.high)) return "–";
  return people(interval.low, digits) + " … " + people(interval.high, digits);
}

}  // namespace libchar
