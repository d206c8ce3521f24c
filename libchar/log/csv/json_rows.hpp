#pragma once
// JSON lines as rows of a table.

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "libchar/log/csv/unpacker.hpp"

namespace libchar::csv {

/// By the first bytes: an object, or an array that begins with one.
bool is_json_rows(std::string_view front);

/// Text of a table, a row for each object, in constant memory. Throws Error(input) E0337 for what is no object.
std::unique_ptr<Unpacker> open_json_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                         const std::string& file);

}  // namespace libchar::csv
