#pragma once
// Digests of logs that somebody took already, as `sha256sum` prints them: a plan need not take them
// again. They are trusted until a worker reads the log.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/fleet/manifest.hpp"

namespace libchar {

struct StatedDigest {
  std::string sha256;  ///< 64 lower-case hexadecimal digits
  std::string where;   ///< "FILE:LINE:COL"
};

/// Of each log, by its absolute path.
using StatedDigests = std::map<std::string, StatedDigest>;

/// 64 hexadecimal digits in lower case; nothing for any other text.
std::optional<std::string> sha256_digits(std::string_view text);

/// Lines "DIGEST  PATH", "DIGEST *PATH" or "SHA256 (PATH) = DIGEST"; paths are relative to the
/// file's folder; empty lines and those that begin with # are left out. Throws Error(input) with
/// the place of any other line, and for two digests of one path.
StatedDigests parse_sums(std::string_view text, const std::string& path);
/// The same of files. Throws Error(input).
StatedDigests read_sums(const std::vector<std::string>& paths);

/// Gives each device the digest of its log, where there is one, and returns how many got none.
/// Throws Error(input) where the manifest states another.
std::size_t state_digests(const StatedDigests& digests, Manifest& manifest);

}  // namespace libchar
