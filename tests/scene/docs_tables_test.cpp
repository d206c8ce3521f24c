// The tables of keys in docs/ are those that the readers and writers use. With LIBCHAR_WRITE_DOCS set in the environment
// they are brought up to date.

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>

#include "libchar/core/fields.hpp"
#include "libchar/log/binary/sidecar.hpp"
#include "libchar/log/reading_fields.hpp"
#include "libchar/model/model_fields.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

// The page with what stands between the marks of `name` replaced.
std::string with_table(const std::string& page, const std::string& name, const std::string& table) {
  const std::string begin = "<!-- keys: " + name + " -->\n", end = "<!-- end of keys -->";
  const std::size_t from = page.find(begin);
  if (from == std::string::npos) return "no mark of " + name;
  const std::size_t to = page.find(end, from);
  if (to == std::string::npos) return "no end of " + name;
  return page.substr(0, from + begin.size()) + table + page.substr(to);
}

void check_table(const std::string& file, const std::string& name, const std::string& table) {
  INFO(file << ": " << name);
  const auto path = test::source_folder() / "docs" / file;
  const std::string page = test::slurp(path);
  const std::string right = with_table(page, name, table);
  if (std::getenv("LIBCHAR_WRITE_DOCS") != nullptr && page != right)
    std::ofstream(path, std::ios::binary) << right;
  else
    CHECK(page == right);
}

template <class T>
void check_table(const std::string& file, const std::string& name, const Fields<T>& fields) {
  check_table(file, name, markdown_table(fields));
}

}  // namespace

TEST_CASE("the tables of keys in docs are those of the readers") {
  check_table("models.md", "sensor model", model_fields());
  check_table("formats.md", "sidecar", sidecar_fields());
  check_table("scenes.md", "scene", scene_fields());
  check_table("scenes.md", "sensor", sensor_fields());
  check_table("scenes.md", "reference", reference_fields());
  check_table("scenes.md", "signal kinds", signal_kinds_table());
  check_table("scenes.md", "tilt", tilt_fields());
  check_table("scenes.md", "fault", fault_fields());
  check_table("scenes.md", "simulation", simulation_fields());
  check_table("scenes.md", "recording", scene_reading_fields());
}
