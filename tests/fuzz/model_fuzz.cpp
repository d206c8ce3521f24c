// Any bytes as a sensor model: JSON when the first byte is odd, YAML else. What is read must be
// written, and what is written must read back to the same text.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/model/model_file.hpp"

using namespace libchar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  std::string written;
  try {
    written = model_yaml(parse_sensor_model(text, data[0] % 2 == 1 ? "m.json" : "m.yaml"));
  } catch (const Error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
    return 0;
  }
  std::string again;
  try {
    again = model_yaml(parse_sensor_model(written, "m.yaml"));
  } catch (const Error& error) {
    again = error.what();
  }
  if (again != written) {
    std::fprintf(stderr, "written:\n%s\nagain:\n%s\n", written.c_str(), again.c_str());
    std::abort();
  }
  return 0;
}
