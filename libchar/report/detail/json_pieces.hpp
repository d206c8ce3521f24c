#pragma once
// What several JSON documents share: their head, texts, an interval.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// The head of a document: its format and version.
Json json_frame(std::string_view format);
/// ["…", …]
Json texts_json(const std::vector<std::string>& texts);
/// [low, high]; null where it is not known.
Json interval_json(const Interval& interval);

}  // namespace libchar
