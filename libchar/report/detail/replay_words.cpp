#include "libchar/report/detail/replay_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/readable.hpp"
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

std::string instant_text(double seconds) {
  return std::isfinite(seconds) ? brief_text(seconds, 8) + " s" : "–";
}

std::string stretch_text(double from_s, double to_s) {
  return instant_text(from_s) + " … " + (std::isfinite(to_s) ? instant_text(to_s) : "the end");
}

}  // namespace libchar
