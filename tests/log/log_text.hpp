#pragma once
// Logs written as text in a test, read back.

#include <fstream>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/shared.hpp"

namespace test {

inline libchar::Recording read_text(const std::string& text, libchar::ReadOptions options = {}) {
  const TemporaryFolder folder;
  const std::string path = (folder / "log.csv").string();
  std::ofstream(path, std::ios::binary) << text;
  return libchar::read_recording(path, options);
}

/// The message of the Error that reading ends with, without the folder's name; "" when it succeeds.
inline std::string failure(const std::string& text, libchar::ReadOptions options = {}) {
  try {
    read_text(text, options);
  } catch (const libchar::Error& error) {
    const std::string said = error.what();
    const std::size_t name = said.find("log.csv");
    return name == std::string::npos ? said : said.substr(name);
  }
  return "";
}

inline std::uint64_t count(const libchar::Recording& recording, const char* code) {
  const libchar::Finding* warning = recording.info.warnings.find(code);
  return warning == nullptr ? 0 : warning->count;
}

}  // namespace test
