#pragma once
// From one log format to another; what is written reads back to the same bits.

#include <string>
#include <vector>

#include "libchar/log/read.hpp"
#include "libchar/log/write.hpp"

namespace libchar {

struct ConvertOptions {
  ReadOptions reading;
  WriteOptions writing;
  bool only_without_warnings = false;  ///< a log that has warnings is read, and nothing is written
};

struct Conversion {
  LogInfo log;
  std::vector<std::string> files;   ///< written, the log first; none: see `only_without_warnings`
  std::vector<std::string> losses;  ///< what the format written cannot hold of this log, in sentences
};

/// Reads the log `from` and writes it as `to`, in constant memory; a log from a pipe whose rate the stamps of `to` need
/// is kept in memory, one from a file is read twice. `to` is there whole or not at all. Throws as read_log and
/// open_log_writer, and Error(usage) where `to` would overwrite what is read.
Conversion convert_log(const std::string& from, const std::string& to, const ConvertOptions& options = {},
                       Progress& progress = no_progress());

}  // namespace libchar
