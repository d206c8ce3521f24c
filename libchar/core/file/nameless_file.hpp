#pragma once

#include <filesystem>

namespace libchar {

/// A file for reading and writing in `folder` ("" is the current one) that has no name: it is gone when its descriptor is
/// closed, however the program ends. -1 and errno where the folder does not let it be.
int open_nameless(const std::filesystem::path& folder);

}  // namespace libchar
