#pragma once
// Where tests find their inputs and the program. Known to one source file only, so that the objects
// of tests do not depend on the folder they were built in.

#include <filesystem>
#include <string>

namespace test {

std::filesystem::path shared_folder();    ///< the recordings beside the checkout
std::filesystem::path fixtures_folder();  ///< of this repository
std::filesystem::path source_folder();    ///< this repository
std::string program();                    ///< the sensorchar that was built with the tests

}  // namespace test
