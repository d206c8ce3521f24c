#pragma once
// A HDF5 file as a container of arrays: the formats hdf5 and matlab (version 7.3) open it.

#include <memory>
#include <string>

#include "libchar/log/arrays/log_array.hpp"

namespace libchar {

/// `kind` stands in the dialect ("HDF5"). Throws Error(input): E0465 for what cannot be read, E0467
/// when the library is not built in.
std::unique_ptr<ArrayContainer> open_hdf5_file(const std::string& path, const std::string& kind);

}  // namespace libchar
