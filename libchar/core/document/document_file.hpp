#pragma once
// Documents are small: their files are read whole.

#include <string>

namespace libchar {

/// Reads a whole small text file: a regular one of at most 16 MiB. Throws Error(input).
std::string read_document_text(const std::string& path);

}  // namespace libchar
