#pragma once
// What a fused log came to: for the terminal and as JSON.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/replay/fuse.hpp"

namespace libchar {

/// A few lines; `files` were written.
std::string fuse_text(const FuseResult& result, const std::vector<std::string>& files);

/// The keys of docs/fuse.md. `command`: as typed.
Json fuse_json(const FuseResult& result,
               const std::vector<std::string>& command,
               const std::vector<std::string>& files);

}  // namespace libchar
