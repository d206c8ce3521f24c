#include "libchar/core/quantity_text.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "libchar/core/error.hpp"

using namespace libchar;

TEST_CASE("a range has two ends, and one that is left out is open") {
  const double open = std::numeric_limits<double>::infinity();
  const struct {
    const char* text;
    double low, high;
  } rows[] = {{"10..600", 10, 600},
              {"10s..end", 10, open},
              {"1min..2min", 60, 120},
              {"50..", 50, open},
              {"..50", 0, 50},
              {"250ms..1h", 0.25, 3600}};
  for (const auto& row : rows) {
    INFO(row.text);
    const Interval range = parse_range(row.text);
    CHECK(range.low == row.low);
    CHECK(range.high == row.high);
  }
  const Interval band = parse_range("100..1.5kHz", RangeOf::rate_hz);
  CHECK(band.low == 100);
  CHECK(band.high == 1500);
  for (const char* text : {"", "..", "..end", "50", "50..10", "10..10", "-1..2", "a..b", "1..2x"}) {
    INFO(text);
    CHECK_THROWS_WITH(parse_range(text), Catch::Contains("E0201"));
  }
  CHECK_THROWS_WITH(parse_range("1s..2s", RangeOf::rate_hz), Catch::Contains("E0201"));
}
