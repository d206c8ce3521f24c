#include "libchar/fleet/detail/manifest_path.hpp"

namespace libchar {

namespace fs = std::filesystem;

std::string absolute_path(const std::string& named, const fs::path& folder) {
  if (named.empty()) return "";
  return (fs::path(named).is_absolute() ? fs::path(named) : folder / named)
      .lexically_normal()
      .string();
}

fs::path folder_of_file(const std::string& path) {
  return fs::absolute(path).parent_path();
}

}  // namespace libchar
