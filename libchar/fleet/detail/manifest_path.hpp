#pragma once
#include <filesystem>
#include <string>

namespace libchar {

/// Absolute and without "..", so that one log has one name; `named` is relative to `folder`. "" stays "".
std::string absolute_path(const std::string& named, const std::filesystem::path& folder);

/// Of a manifest or a file of digests: what the paths in it are relative to.
std::filesystem::path folder_of_file(const std::string& path);

}  // namespace libchar
