// The table of log formats: who asks it gets the same answer, and the page of formats has a row for each.

#include "libchar/log/formats.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "libchar/log/detail/format.hpp"
#include "libchar/log/write.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

// As docs/formats.md has it.
std::string row_of(const LogFormat& format) {
  std::string files = format.suffixes.empty() ? "" : fmt::format("`{}`", fmt::join(format.suffixes, " "));
  if (!format.otherwise.empty()) files += fmt::format("{}{}", files.empty() ? "" : ", ", format.otherwise);
  return fmt::format("| {} | {} | {} | {} | {} | {} | yes | {} |\n", format.title, files, format.names, format.units,
                     format.rate, format.start, format.written_suffixes.empty() ? "no" : "yes");
}

}  // namespace

TEST_CASE("docs/formats.md has the row of every format and no other") {
  const std::string page = test::slurp(test::source_folder() / "docs/formats.md");
  std::string rows;
  for (const std::string& name : format_words())
    if (const Format* format = find_format(name)) rows += row_of(format->about);
  const std::string head = "|---|---|---|---|---|---|---|---|\n";
  const std::size_t begin = page.find(head);
  REQUIRE(begin != std::string::npos);
  const std::size_t end = page.find("\n\n", begin);
  CHECK(page.substr(begin + head.size(), end + 1 - begin - head.size()) == rows);
}

TEST_CASE("names and suffixes of formats are taken once, and every format can be told from a file") {
  std::set<std::string_view> names, suffixes;
  for (const Format& format : formats()) {
    INFO(format.about.name);
    CHECK(names.insert(format.about.name).second);
    for (const std::string_view suffix : format.about.suffixes) CHECK(suffixes.insert(suffix).second);
    for (const std::string_view suffix : format.about.written_suffixes)
      CHECK(format_by_suffix("x" + std::string(suffix)) == &format);
    CHECK((format.sniff != nullptr || format.certain != nullptr));
    CHECK((format.open != nullptr) != (format.topics != nullptr));
    CHECK(format.about.topics == (format.topics != nullptr));
    CHECK((format.write == nullptr) == format.about.written_suffixes.empty());
  }
  CHECK(std::count_if(formats().begin(), formats().end(),
                      [](const Format& format) { return format.about.from_pipes; }) == 1);
}

TEST_CASE("words and suffixes for options come from the table") {
  std::vector<std::string> words = {"auto"};
  for (const Format& format : formats()) words.emplace_back(format.about.name);
  std::sort(words.begin() + 1, words.end());
  CHECK(format_words() == words);
  CHECK(written_format_words() == std::vector<std::string>{"auto", "csv", "npy", "raw"});
  CHECK_THAT(readable_files(), Catch::StartsWith(".bag, .csv, ") && Catch::Contains(".npy, .npz, raw with sidecar"));
  CHECK(written_suffixes() == ".csv, .npy, .f64, .f32, .bin, .raw");
  CHECK(format_to_write("LOG.CSV", {}).name == "csv");
  CHECK_THROWS_WITH(format_to_write("log.tsv", {}), Catch::Contains("end the name in one of .csv"));
}

TEST_CASE("a log has stamps where its format holds them and nobody leaves them out") {
  WriteOptions without;
  without.time_column = false;
  CHECK(writes_stamps("log.csv", {}));
  CHECK_FALSE(writes_stamps("log.csv", without));
  CHECK_FALSE(writes_stamps("log.npy", {}));
  CHECK_FALSE(writes_stamps("log.f64", {}));
}
