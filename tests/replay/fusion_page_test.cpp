// The table of keys in docs/fuse.md is that of the reader. With LIBCHAR_WRITE_DOCS set in the
// environment it is brought up to date.
#include <catch2/catch.hpp>

#include "libchar/replay/fusion_file.hpp"
#include "tests/support/docs_table.hpp"

using namespace libchar;

TEST_CASE("the keys of fusion.yaml in docs are those of its reader") {
  const auto check = [](const char* name, const std::string& table) {
    test::check_docs_table("fuse.md", "keys", name, table);
  };
  check("file", markdown_table(fusion_fields()));
  check("sensors", markdown_table(fusion_sensor_fields()));
  check("algorithms", markdown_table(fusion_algorithm_fields()));
}
