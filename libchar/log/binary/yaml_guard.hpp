#pragma once
// YAML with the guards that yaml-cpp lacks, as a JSON document.

#include <string>
#include <string_view>

#include "libchar/core/json.hpp"

namespace libchar {

/// One YAML document of plain keys, texts and numbers: no aliases, anchors, tags, merge keys,
/// duplicate keys or second document; depth <= 64, size <= 16 MiB. A plain scalar that reads as a
/// decimal number becomes one ("010" and "0x10" are texts, .nan and .inf too). Throws Error(input)
/// with FILE:LINE:COL.
Json parse_guarded_yaml(std::string_view text, const std::string& file);

}  // namespace libchar
