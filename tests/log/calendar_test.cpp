// Dates and clock times: known answers of `date -u -d`, and what is no date.

#include "libchar/log/time/calendar.hpp"

#include <catch2/catch.hpp>

using namespace libchar;

namespace {

constexpr std::int64_t kBillion = 1000000000;

std::int64_t ns(std::string_view text, DateOrder order = DateOrder::day_first) {
  const auto stamp = read_calendar(text, order);
  return stamp ? stamp->ns : -1;
}

}  // namespace

TEST_CASE("calendar stamps are exact to the nanosecond, whatever their form") {
  const std::int64_t noon = 1714564800 * kBillion;  // 2024-05-01T12:00:00Z
  for (const char* text : {"2024-05-01T12:00:00Z",
                           "2024-05-01 12:00:00",
                           "2024-05-01T14:00:00+02:00",
                           "2024-05-01T04:30:00-0730",
                           "2024/05/01 12:00",
                           "01.05.2024 12:00:00",
                           "1.5.2024, 12:00:00",
                           "01/05/24 12:00:00 PM",
                           "1 May 2024 12:00:00",
                           "01-May-2024 12:00:00",
                           "May 1, 2024 12:00:00 p.m.",
                           "20240501T120000Z",
                           "2024-05-01 12:00:00 UTC"}) {
    INFO(text);
    CHECK(ns(text) == noon);
  }
  CHECK(ns("5/1/2024 12:00", DateOrder::month_first) == noon);
  CHECK(ns("2024-05-01 12:00:00.123456789") == noon + 123456789);
  CHECK(ns("2024-05-01 12:00:00,5") == noon + 500000000);
  CHECK(ns("2024-05-01 12:00:00:042") == noon + 42000000);
  CHECK(ns("2024-05-01 12:00:00.1234567895") == noon + 123456790);
  CHECK(ns("1969-12-31T23:59:59Z") == -kBillion);
  CHECK(ns("12:30:01.5") == (12 * 3600 + 30 * 60 + 1) * kBillion + 500000000);
  CHECK(ns("12:00:00 AM") == 0);
}

TEST_CASE("what is no day or no time of day is refused") {
  for (const char* text : {"2024-02-30",
                           "2023-02-29 00:00",
                           "2024-13-01",
                           "2024-05-01 25:00:00",
                           "2024-05-01 12:60",
                           "2024-05-01 12:00:0x",
                           "2024-05-01x",
                           "1.2.3",
                           "20240501",
                           "192.168.1.1",
                           "13:00 PM",
                           "12",
                           "1,234.5",
                           "",
                           "node-07x"}) {
    INFO(text);
    CHECK_FALSE(read_calendar(text, DateOrder::day_first));
  }
}

TEST_CASE("the order of day and month comes from the data, else it is a guess") {
  CHECK(date_style({"01/05/2024", "13/05/2024"}, false).order == DateOrder::day_first);
  CHECK_FALSE(date_style({"01/05/2024", "13/05/2024"}, false).ambiguous);
  CHECK(date_style({"05/13/2024"}, false).order == DateOrder::month_first);
  CHECK(date_style({"05/01/2024"}, false).order == DateOrder::month_first);
  CHECK(date_style({"05/01/2024"}, false).ambiguous);
  CHECK(date_style({"05/01/2024"}, true).order == DateOrder::day_first);
  CHECK(date_style({"05.01.2024"}, false).order == DateOrder::day_first);
  CHECK_FALSE(date_style({"2024-05-01"}, false).ambiguous);
}
