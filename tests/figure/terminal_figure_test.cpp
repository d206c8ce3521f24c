#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "libchar/core/text/text_table.hpp"
#include "libchar/figure/draw_figure.hpp"
#include "tests/figure/figure_parts.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

std::vector<std::string> terminal_lines(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

Chart terminal_chart(std::vector<SourceCurve> curves) {
  const FigureSource source = test::figure_source_of(std::move(curves));
  return make_figure({&source, 1}, {});
}

bool has_dots(const std::string& line) {
  return line.find("\xe2\xa0") != std::string::npos || line.find("\xe2\xa1") != std::string::npos ||
         line.find("\xe2\xa2") != std::string::npos || line.find("\xe2\xa3") != std::string::npos;
}

}  // namespace

TEST_CASE("a curve in a terminal is as wide as it, has decades at both axes and no escapes") {
  for (const std::size_t columns : {40U, 80U, 133U}) {
    const std::string text = terminal_figure(terminal_chart({test::figure_curve("g", "deg/s")}), {columns, 16, false});
    for (const std::string& line : terminal_lines(text)) CHECK(width_of(line) <= columns);
    CHECK_THAT(text, !Contains("\x1b"));
    CHECK_THAT(text, Contains("Overlapping Allan deviation [deg/s]") && Contains("Averaging time"));
    CHECK_THAT(text, Contains("0.01 ┤") && Contains("┤") && Contains("┬"));
    // The axis stands one blank behind the longest label.
    std::size_t longest = 0, shortest_gap = columns;
    for (const std::string& line : terminal_lines(text)) {
      const std::size_t axis = line.find("┤");
      if (axis == std::string::npos) continue;
      const std::string label = line.substr(0, axis);
      longest = std::max(longest, label.find_last_not_of(' ') + 1);
      shortest_gap = std::min(shortest_gap, label.size() - label.find_last_not_of(' ') - 1);
    }
    CHECK(longest > 0);
    CHECK(shortest_gap == 1);
  }
}

TEST_CASE("dots stand where the curve is") {
  // A straight line from the upper left to the lower right corner: each row has dots, further right than the row above.
  SourceCurve line = test::figure_curve("g", "deg/s");
  for (std::size_t i = 0; i < line.x.size(); ++i) line.y[i] = 1 / line.x[i];
  line.low95.clear();
  line.high95.clear();
  const auto lines = terminal_lines(terminal_figure(terminal_chart({line}), {80, 20, false}));
  std::size_t last = 0;
  std::size_t rows = 0;
  for (const std::string& row : lines) {
    if (!has_dots(row)) continue;
    ++rows;
    std::size_t at = row.find("\xe2\xa0");
    for (const char* lead : {"\xe2\xa1", "\xe2\xa2", "\xe2\xa3"}) at = std::min(at, row.find(lead));
    const std::size_t column = width_of(row.substr(0, at));
    CHECK(column >= last);
    last = column;
  }
  CHECK(rows >= 17);
  CHECK(last > 60);
}

TEST_CASE("several curves have letters, and colours where they are wanted") {
  const Chart chart = terminal_chart({test::figure_curve("one", "g"), test::figure_curve("two", "g")});
  const std::string plain = terminal_figure(chart, {80, 16, false});
  CHECK_THAT(plain, Contains(" a one   b two\n") && !Contains("\x1b"));
  const std::string coloured = terminal_figure(chart, {80, 16, true});
  CHECK_THAT(coloured, Contains("\x1b[34m") && Contains("\x1b[31m") && Contains("\x1b[0m"));
}
