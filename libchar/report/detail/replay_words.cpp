#include "libchar/report/detail/replay_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/decimal.hpp"
#include "libchar/core/readable.hpp"
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
  const std::string number = number_text(value, digits);
  return unit.empty() || !std::isfinite(value) ? number : number + " " + unit;
}

std::string percent_text(double share, int digits) {
  if (!std::isfinite(share)) return "–";
  const double percent = 100 * share;
  // A regret of 3e-7 is none: it would be written as a power of ten.
  if (std::fabs(percent) < 0.005) return "0.00 %";
  if (std::fabs(percent) >= 1000) return number_text(percent, 4) + " %";
  return fmt::format("{:.{}f} %", percent, std::fabs(percent) < 10 ? digits : digits > 1 ? 1 : 0);
}

std::string instant_text(double seconds) {
  return std::isfinite(seconds) ? significant(seconds, 8) + " s" : "–";
}

std::string stretch_text(double from_s, double to_s) {
  return instant_text(from_s) + " … " + (std::isfinite(to_s) ? instant_text(to_s) : "the end");
}

std::string interval_text(const Interval& interval, int digits) {
  if (!std::isfinite(interval.low) || !std::isfinite(interval.high)) return "–";
  return number_text(interval.low, digits) + " … " + number_text(interval.high, digits);
}

}  // namespace libchar
