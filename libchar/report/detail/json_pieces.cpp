#include "libchar/report/detail/json_pieces.hpp"

// The JSON pieces that the verbs share; the keys are those of docs/json.md, which may grow and
// never change.

#include <cmath>
#include <nlohmann/json.hpp>

namespace libchar {
Json texts_json(const std::vector<std::string>& texts) {
  Json out = Json::array();
  for (const std::string& text : texts) out.push_back(json_text(text));
  return out;
}

Json json_frame(std::string_view format) {
  return {{"format", format}, {"version", 1}};
}

Json interval_json(const Interval& interval) {
  if (std::isnan(interval.low) || std::isnan(interval.high)) return nullptr;
  return Json::array({json_number(interval.low), json_number(interval.high)});
}

}  // namespace libchar
