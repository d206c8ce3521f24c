#pragma once
// A table of a page in docs/ that is made of what the program knows. With LIBCHAR_WRITE_DOCS set in
// the environment the page is brought up to date instead of checked.

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/support/shared.hpp"

namespace test {

/// The page with what stands between `<!-- KIND: NAME -->` and `<!-- end of KIND -->` replaced.
inline std::string with_table(const std::string& page, const std::string& kind, const std::string& name,
                              const std::string& table) {
  const std::string begin = "<!-- " + kind + ": " + name + " -->\n", end = "<!-- end of " + kind + " -->";
  const std::size_t from = page.find(begin);
  if (from == std::string::npos) return "no mark of " + name;
  const std::size_t to = page.find(end, from);
  if (to == std::string::npos) return "no end of " + name;
  return page.substr(0, from + begin.size()) + table + page.substr(to);
}

inline void check_docs_table(const std::string& file, const std::string& kind, const std::string& name,
                             const std::string& table) {
  INFO(file << ": " << name);
  const auto path = source_folder() / "docs" / file;
  const std::string page = slurp(path);
  const std::string right = with_table(page, kind, name, table);
  if (std::getenv("LIBCHAR_WRITE_DOCS") != nullptr && page != right)
    std::ofstream(path, std::ios::binary) << right;
  else
    CHECK(page == right);
}

}  // namespace test
