#pragma once
// Paths of known answers (fixtures/known, in this repository) and of recordings that live beside the
// checkout (never inside it, for their size and licences).

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "tests/support/places.hpp"

namespace test {

/// A recording or a table beside the checkout: say NEEDS_SHARED(name) first.
inline std::filesystem::path shared(const std::string& name) { return test::shared_folder() / name; }
inline std::filesystem::path fixture(const std::string& name) { return test::fixtures_folder() / name; }
/// A known answer of this repository: fixtures/README.md has their sources and licences.
inline std::filesystem::path known(const std::string& name) { return test::fixtures_folder() / "known" / name; }

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A fresh folder under the system's temporary directory, removed with its contents at the end of the scope.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "libchar-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::filesystem::path path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace test

/// First line of a test that reads the shared folder. In a clone without it the test says SKIPPED and
/// ends; ctest lists it as skipped, not as passed (tests/CMakeLists.txt). With the folder there, a file
/// that is missing from it is a failure.
#define NEEDS_SHARED(name)                                                       \
  if (!std::filesystem::exists(test::shared("data/INDEX.md"))) {                 \
    WARN("SKIPPED: " << test::shared(name).string() << " is not in this clone"); \
    return;                                                                      \
  }                                                                              \
  REQUIRE(std::filesystem::exists(test::shared(name)))
