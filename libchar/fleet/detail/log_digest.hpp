#pragma once
#include <string>

namespace libchar {

/// SHA-256 of the whole file, 64 hexadecimal digits. Throws Error(input).
std::string digest_of_log(const std::string& path);

}  // namespace libchar
