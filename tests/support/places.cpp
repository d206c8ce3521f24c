#include "tests/support/places.hpp"

namespace test {

std::filesystem::path shared_folder() { return LIBCHAR_SHARED_DIR; }
std::filesystem::path fixtures_folder() { return LIBCHAR_FIXTURES_DIR; }
std::filesystem::path source_folder() { return LIBCHAR_SOURCE_DIR; }
std::string program() { return SENSORCHAR_PROGRAM; }

}  // namespace test
