#pragma once
// LabVIEW's measurement files as rows of a table.

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "libchar/log/csv/unpacker.hpp"

namespace libchar::csv {

/// By the first bytes.
bool is_lvm(std::string_view front);

/// Text of a table, in constant memory. Throws Error(input) E0340 for what does not keep to the format.
std::unique_ptr<Unpacker> open_lvm_rows(std::function<std::size_t(char*, std::size_t)> stored, const std::string& file);

}  // namespace libchar::csv
