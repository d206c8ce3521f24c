#pragma once
// Raw binary numbers with a JSON sidecar.

#include <memory>
#include <string>

#include "libchar/log/write.hpp"

namespace libchar {

std::unique_ptr<LogWriter> write_raw(const std::string& path,
                                     const LogInfo& info,
                                     const WriteOptions& options);

}  // namespace libchar
