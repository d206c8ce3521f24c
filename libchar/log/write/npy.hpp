#pragma once
// NumPy's .npy: a structured array when the channels have names, else a plain one.

#include <memory>
#include <string>

#include "libchar/log/write.hpp"

namespace libchar {

std::unique_ptr<LogWriter> write_npy(const std::string& path,
                                     const LogInfo& info,
                                     const WriteOptions& options);

}  // namespace libchar
