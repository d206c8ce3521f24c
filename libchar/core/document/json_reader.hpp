#pragma once
// JSON with the places of its values.

#include <string>
#include <string_view>

#include "libchar/core/document/document.hpp"

namespace libchar {

/// The tree of a JSON document, by parse_json's rules. Throws Error(input) with FILE:LINE:COL (byte N).
Document parse_json_document(std::string_view text, const std::string& file);

}  // namespace libchar
