// Any bytes as a document: JSON when the first byte is odd, YAML else. The tree as JSON reads back to the same tree.

#include <nlohmann/json.hpp>

#include "libchar/core/document/document.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  Json tree;
  try {
    tree = as_json(parse_document(text, data[0] % 2 == 1 ? "d.json" : "d.yaml"));
  } catch (const Error& error) {
    fuzz::said(error);
    return 0;
  }
  const std::string written = tree.dump();
  try {
    fuzz::expect_same("a tree and its JSON", written, as_json(parse_document(written, "d.json")).dump());
  } catch (const Error& error) {
    fuzz::fail("a tree whose JSON is refused", written, error.what());
  }
  return 0;
}
