#pragma once
// What writes a log: a function of each format that can be written.

#include <memory>
#include <string>

#include "libchar/log/write.hpp"

namespace libchar {

/// As this project writes CSV: comma, point, one header line NAME[UNIT].
std::unique_ptr<LogWriter> write_csv(const std::string& path, const LogInfo& info, const WriteOptions& options);
/// NumPy's .npy: a structured array when the channels have names, else a plain one.
std::unique_ptr<LogWriter> write_npy(const std::string& path, const LogInfo& info, const WriteOptions& options);
/// Raw binary numbers with a JSON sidecar.
std::unique_ptr<LogWriter> write_raw(const std::string& path, const LogInfo& info, const WriteOptions& options);

}  // namespace libchar
