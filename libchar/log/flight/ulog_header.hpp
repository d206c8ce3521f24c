#pragma once
// The beginning of a ULog file: is it one, can it be read, and which stretches of it hold messages.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/warnings.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/flight/ulog_walk.hpp"

namespace libchar {

struct UlogHeader {
  int version = 0;
  std::vector<UlogStretch> stretches;  ///< the log, then what was appended
};

/// Do the first bytes say ULog, or ULog that is encrypted?
bool is_ulog(std::string_view first_bytes);

/// Throws Error(input) for what is no ULog (E0480), is encrypted (E0481) or needs what this reader lacks (E0482).
UlogHeader read_ulog_header(const BinaryFile& file, Warnings& warnings);

/// What an information message says, as text: the value of a char array, or a version of four bytes
/// as "v1.14.3"; "" for others.
struct UlogInfo {
  std::string key, value;
};
UlogInfo read_ulog_info(std::span<const std::byte> body);

}  // namespace libchar
