// The examples of docs/scenes.md, read as people read them; what a block's first line refuses is
// refused, the others read back after writing.

#include <catch2/catch.hpp>
#include <sstream>

#include "libchar/scene/scene_file.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/places.hpp"

TEST_CASE("every example of docs/scenes.md is read as the page says") {
  const test::SceneBench bench;
  std::istringstream page(test::slurp(test::source_folder() / "docs/scenes.md"));
  std::string text, code;
  bool inside = false;
  int good = 0, bad = 0;
  for (std::string line; std::getline(page, line);) {
    if (!inside && line.starts_with("```yaml")) {
      inside = true;
      text.clear();
      const std::size_t at = line.find("error=");
      code = at == std::string::npos ? "" : line.substr(at + 6);
    } else if (inside && line == "```") {
      inside = false;
      INFO(text);
      const std::string said = bench.refusal(text);
      if (code.empty()) {
        CHECK(said.empty());
        const std::string written = libchar::scene_yaml(bench.read(text));
        CHECK(libchar::scene_yaml(bench.read(written)) == written);
        ++good;
      } else {
        CHECK(said.find("error " + code) != std::string::npos);
        ++bad;
      }
    } else if (inside) {
      text += line + "\n";
    }
  }
  CHECK(good >= 6);
  CHECK(bad >= 4);
}
