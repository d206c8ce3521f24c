#pragma once
// The log that every fixture of fixtures/arrays holds (make.py): 20 rows at 100 Hz, gyr = (k, -k /
// 2, k / 4), acc = (1000 + k, k², -1).

#include <catch2/catch.hpp>
#include <fstream>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/shared.hpp"

namespace test {

inline libchar::Recording array_log(const std::string& name, const libchar::ReadOptions& options = {}) {
  return libchar::read_recording(fixture("arrays/" + name).string(), options);
}

/// What reading a fixture ends with; "" when it succeeds.
inline std::string array_fault(const std::string& name, const libchar::ReadOptions& options = {}) {
  try {
    array_log(name, options);
  } catch (const libchar::Error& error) {
    return error.what();
  }
  return "";
}

/// The same of a file of these bytes.
inline std::string with_bytes(const std::string& name, const std::string& bytes,
                              libchar::Recording* recording = nullptr, const libchar::ReadOptions& options = {}) {
  const TemporaryFolder folder;
  const std::string path = (folder / name).string();
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    libchar::Recording read = libchar::read_recording(path, options);
    if (recording != nullptr) *recording = std::move(read);
  } catch (const libchar::Error& error) {
    return error.what();
  }
  return "";
}

inline std::string joined(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += line + "; ";
  return all;
}

inline void check_common_log(const libchar::Recording& log) {
  REQUIRE(log.info.channels.size() == 6);
  CHECK(log.info.rows == 20);
  CHECK(log.info.time.rate_hz == Approx(100).epsilon(1e-9));
  const char* const names[] = {"gyr_0", "gyr_1", "gyr_2", "acc_0", "acc_1", "acc_2"};
  for (std::size_t c = 0; c < 6; ++c) {
    // Containers have orders of their own.
    std::size_t at = 0;
    while (at < 6 && log.info.channels[at].name != names[c]) ++at;
    REQUIRE(at < 6);
    REQUIRE(log.samples[at].size() == 20);
    for (std::size_t i = 0; i < 20; ++i) {
      const auto k = static_cast<double>(i);
      const double expected[] = {k, -k / 2, k / 4, 1000 + k, k * k, -1};
      CHECK(log.samples[at][i] == expected[c]);
    }
  }
}

}  // namespace test
