// Any bytes as fusion.yaml: JSON when the first byte is odd, YAML else. What is read must be
// written, and what is written must read back to the same text.

#include "libchar/replay/fusion_file.hpp"
#include "tests/fuzz/fuzz_support.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::round_trip(data, size, [](std::string_view text, const std::string& file) {
    return libchar::fusion_yaml(libchar::parse_fusion_file(text, file));
  });
  return 0;
}
