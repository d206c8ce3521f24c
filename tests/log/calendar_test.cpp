// Dates and clock times: known answers of `date -u -d`, and what is no date.

#include "libchar/log/time/calendar.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/log/log_text.hpp"

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
  for (const char* text :
       {"2024-05-01T12:00:00Z", "2024-05-01 12:00:00", "2024-05-01T14:00:00+02:00", "2024-05-01T04:30:00-0730",
        "2024/05/01 12:00", "01.05.2024 12:00:00", "1.5.2024, 12:00:00", "01/05/24 12:00:00 PM", "1 May 2024 12:00:00",
        "01-May-2024 12:00:00", "May 1, 2024 12:00:00 p.m.", "20240501T120000Z", "2024-05-01 12:00:00 UTC"}) {
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
  for (const char* text : {"2024-02-30", "2023-02-29 00:00", "2024-13-01", "2024-05-01 25:00:00", "2024-05-01 12:60",
                           "2024-05-01 12:00:0x", "2024-05-01x", "1.2.3", "20240501", "192.168.1.1", "13:00 PM", "12",
                           "1,234.5", "", "node-07x"}) {
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

TEST_CASE("times of day as digits, hhmmss, are told from numbers by their even steps") {
  const auto text = [](const std::string& name, int begin, double rate, int samples, const char* form) {
    std::string out = name + ",x\n";
    for (int i = 0; i < samples; ++i) {
      const double s = begin + i / rate;
      const int whole = static_cast<int>(s) % 86400;
      out += fmt::format(fmt::runtime(form),
                         whole / 3600 * 10000 + whole / 60 % 60 * 100 + whole % 60 + (s - std::floor(s))) +
             fmt::format(",{}\n", i % 7);
    }
    return out;
  };
  for (const char* form : {"{:09.2f}", "{:.2f}"})
    for (const double rate : {1.0, 5.0, 10.0})
      for (const int begin : {187, 45296, 86000}) {
        const Recording r = test::read_text(text("time", begin, rate, 4000, form));
        INFO(form << ", " << rate << " Hz from " << begin);
        CHECK(r.info.time.rate_hz == Approx(rate));
        CHECK(r.samples[0].size() == 4000);
      }
  // Seconds, hundreds of them, and counts stay what they are.
  std::string seconds = "time,x\n", hundreds = "time,x\n";
  for (int i = 0; i < 900; ++i) {
    seconds += fmt::format("{},{}\n", 10000 + i, i % 7);
    hundreds += fmt::format("{},{}\n", 10000 + 100 * i, i % 7);
  }
  CHECK(test::read_text(seconds).samples[0].size() == 900);
  CHECK(test::read_text(hundreds).samples[0].size() == 900);
  // In front of many columns that could be times of day as well.
  std::string wide = "time", row;
  for (int k = 0; k < 300; ++k) wide += fmt::format(",utc{}", k), row += fmt::format(",{}", 120000 + k % 40);
  wide += "\n";
  for (int i = 0; i < 900; ++i) wide += fmt::format("{:06}{}\n", 120000 + i / 60 * 100 + i % 60, row);
  const Recording r = test::read_text(wide);
  CHECK(r.info.time.column == "time");
  CHECK(r.info.time.rate_hz == Approx(1));
  CHECK(r.samples.size() == 300);
}
