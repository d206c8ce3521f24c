// Tables for a terminal: columns, widths, wrapping.
#include "libchar/core/text/text_table.hpp"

#include <catch2/catch.hpp>
#include <sstream>

#include "libchar/core/table/detail/formats.hpp"

using libchar::text_table;
using libchar::width_of;
using libchar::wrapped;

namespace {

std::size_t widest(const std::string& text) {
  std::istringstream lines(text);
  std::size_t most = 0;
  for (std::string line; std::getline(lines, line);) most = std::max(most, width_of(line));
  return most;
}

const std::vector<std::vector<std::string>> kTable = {
    {"term", "value", "interval", "in other words"},
    {"white noise", "0.00401", "0.00398 … 0.00404", "0.2406 deg/√h, 0.005671 deg/s/√Hz"},
    {"bias instability", "0.00426", "0.00384 … 0.00472", "15.34 deg/h"}};

}  // namespace

TEST_CASE("wrapped: between words, never inside one, with an indent that counts") {
  CHECK(wrapped("one two three", 7) == "one two\nthree");
  CHECK(wrapped("one two three", 8, "  ") == "  one\n  two\n  three");
  CHECK(wrapped("incomprehensibilities are long", 5) == "incomprehensibilities\nare\nlong");
  CHECK(wrapped("°°° °°°", 7) == "°°° °°°");
  CHECK(wrapped("", 10, "  ") == "  ");
}

TEST_CASE("a table as wide as it wants without a width, and with one that is enough") {
  const std::string text = text_table(kTable, "  ", true);
  CHECK(text_table(kTable, "  ", true, 200) == text);
  CHECK(text_table(kTable, "  ", true, widest(text)) == text);
  CHECK(text.find("  bias instability  0.00426") != std::string::npos);
}

TEST_CASE("a table fits any width from 44 characters on, and loses no cell") {
  for (std::size_t width = 44; width < 100; ++width) {
    INFO(width);
    const std::string text = text_table(kTable, "  ", true, width);
    CHECK(widest(text) <= width);
    for (const auto& row : kTable)
      for (const std::string& cell : row) {
        std::istringstream words(cell);
        for (std::string word; words >> word;) CHECK(text.find(word) != std::string::npos);
      }
  }
}

TEST_CASE("a narrow table is cut into several, each with the first column and its heads") {
  CHECK(text_table({{"a", "bbbb", "cccc"}, {"1", "2", "3"}}, "", false, 8) == "a  bbbb\n1     2\na  cccc\n1     3\n");
}
