#pragma once
// MATLAB files of version 4.

#include <memory>
#include <string>
#include <string_view>

#include "libchar/log/arrays/log_array.hpp"

namespace libchar {

/// By the head of the first matrix.
bool is_matlab4(std::string_view first_bytes);

/// Throws Error(input) E0464 for what is broken, with its byte.
std::unique_ptr<ArrayContainer> open_matlab4_file(const std::string& path);

}  // namespace libchar
