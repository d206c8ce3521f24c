#pragma once
// CSV as this project writes it: comma, point, one header line NAME[UNIT].

#include <memory>
#include <string>

#include "libchar/log/write.hpp"

namespace libchar {

std::unique_ptr<LogWriter> write_csv(const std::string& path,
                                     const LogInfo& info,
                                     const WriteOptions& options);

}  // namespace libchar
