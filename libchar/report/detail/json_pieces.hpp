#pragma once
// What several JSON documents share: their head, texts, an interval.

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// The head of a document: its format and version.
Json json_frame(std::string_view format);
/// ["…", …]
Json texts_json(const std::vector<std::string>& texts);
/// [VALUE(part), …], null for a number that is not known; `value`: a function, or a member of a part.
template <class Parts, class Value>
Json list_json(const Parts& parts, Value value) {
  Json out = Json::array();
  for (const auto& part : parts) {
    const auto one = std::invoke(value, part);
    if constexpr (std::is_floating_point_v<decltype(one)>)
      out.push_back(json_number(one));
    else
      out.push_back(one);
  }
  return out;
}
/// [low, high]; null where it is not known.
Json interval_json(const Interval& interval);

}  // namespace libchar
