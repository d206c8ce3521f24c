// docs/replay.md has the row of every fusion algorithm and no other.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libchar/fusion/registry.hpp"
#include "libchar/replay/view/words.hpp"
#include "tests/support/docs_table.hpp"

using namespace libchar;

TEST_CASE("docs/replay.md: the table of algorithms") {
  std::string rows = "| name | algorithm | source | needs |\n|---|---|---|---|\n";
  for (const fusion::Entry& entry : fusion::algorithms())
    rows += fmt::format("| `{}` | {} | {} | {} |\n", entry.description->name, entry.description->title,
                        entry.description->source, fmt::join(needs_in_words(*entry.description), "; "));
  test::check_docs_table("replay.md", "table", "algorithms", rows);
}
