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
                           "2024-05-01 12:00:00 UTC",
                           "Wed May  1 12:00:00 2024",
                           "Wed May 1 12:00:00 UTC 2024",
                           "Wed, 1 May 2024 12:00:00 +0000",
                           "2024-122T12:00:00",
                           "2024:122:12:00:00",
                           "2024:05:01 12:00:00",
                           "2024-05-01-12-00-00",
                           "2024-05-01_12-00-00",
                           "2024_05_01_12_00_00",
                           "2024_05_01 12:00:00",
                           "20240501_120000",
                           "2024-05-01 14:00:00.000+0200 [Europe/Berlin]",
                           "2024年5月1日 12时00分00秒",
                           "2024年05月01日 下午 12:00:00",
                           "2024년 5월 1일 12시 00분 00초",
                           "2024-05-01 오후 12:00:00",
                           "01/05/2024 12h00",
                           "1. Mai 2024 12:00:00",
                           "01-mai-2024 12:00:00",
                           "1 mayo 2024 12:00:00",
                           "2024-05-01T12:00:00Z[UTC]"}) {
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
  for (const char* text :
       {"2024-05-01_12-00-00-042", "2024_05_01_12_00_00.042", "20240501_120000_042", "2024-05-01 12:00:00.042,000"}) {
    INFO(text);
    CHECK(ns(text) == noon + 42000000);
  }
  CHECK(ns("12:5:7") == (12 * 3600 + 5 * 60 + 7) * kBillion);
  CHECK(ns("1 day, 2:03:04") == (26 * 3600 + 3 * 60 + 4) * kBillion);
  CHECK(ns("0 days 00:00:01.5") == 1500000000);
  for (const char* text : {"1 02:03:04", "1.02:03:04", "1d 02:03:04", "26:03:04", "26h03m04s", "26 h 3 min 4 s"}) {
    INFO(text);
    CHECK(ns(text) == (26 * 3600 + 3 * 60 + 4) * kBillion);
  }
  CHECK(ns("23h40") == (23 * 60 + 40) * 60 * kBillion);
  CHECK(ns("35:10") == (35 * 60 + 10) * kBillion);  // no hour of a day
  CHECK(ns("75:03.5") == (75 * 60 + 3) * kBillion + 500000000);
  CHECK(ns("오전 00:05:00") == 300 * kBillion);
  CHECK(ns("24-05-01 12:00", DateOrder::year_first) == noon);
  for (const char* text : {"20240501120000", "202405011200", "2024050112", "240501120000"}) {
    INFO(text);
    const auto stamp = read_date_digits(text);
    REQUIRE(stamp);
    CHECK(stamp->ns == noon);
  }
  CHECK(read_date_digits("20240501120000.25")->ns == noon + 250000000);
  CHECK(read_date_digits("20240501")->ns == noon - 43200 * kBillion);
  for (const char* text : {"20241301120000", "20240501250000", "2024050112000", "2024050.5", "20240501.5", "x"}) {
    INFO(text);
    CHECK_FALSE(read_date_digits(text));
  }
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
                           "node-07x",
                           "2024-366x",
                           "2024-367",
                           "1:2",
                           "Sat",
                           "Mon 5",
                           "12:5",
                           "1 day, 26:03:04",
                           "23h",
                           "5月",
                           "10 hm",
                           "2024-05-01 12:00:00-042 x"}) {
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
  CHECK(date_style({"24-03-14", "24-03-15"}, false).order == DateOrder::year_first);  // a day, not a year
  CHECK(date_style({"14-03-24", "15-03-24"}, false).order == DateOrder::day_first);
  CHECK(date_style({"99/12/31", "00/01/01"}, false).order == DateOrder::year_first);
  CHECK_FALSE(date_style({"99/12/31", "00/01/01"}, false).ambiguous);  // the second alone would be a day's
  CHECK_FALSE(date_style({"14.03.24", "15.03.24"}, false).ambiguous);
  CHECK(date_style({"24/03/01", "24/03/02", "24/03/12"}, false).order == DateOrder::year_first);  // by the steps
  CHECK(date_style({"24/03/12", "24/03/12"}, false).order == DateOrder::day_first);
  CHECK(date_style({"24/03/12", "25/03/12"}, false).order == DateOrder::day_first);
}

TEST_CASE("durations of ISO 8601 are stamps") {
  CHECK(ns("PT12.5S") == 12500000000);
  CHECK(ns("P0DT00H01M02.5S") == 62500000000);
  CHECK(ns("P2DT1H") == 49 * 3600 * kBillion);
  CHECK(ns("PT3M") == 180 * kBillion);
  for (const char* text : {"P1Y", "PT", "P3DT", "PT5", "PT1S2M", "PT1.5M", "P99999DT1S"}) {
    INFO(text);
    CHECK(ns(text) == -1);
  }
  std::string text = "elapsed,x\n";
  for (int i = 0; i < 900; ++i) text += fmt::format("PT{}M{:.1f}S,{}\n", i / 120, i % 120 * 0.5, i % 7);
  CHECK(test::read_text(text).info.time.rate_hz == Approx(2).epsilon(1e-6));
}

TEST_CASE("a day of the week in front of a date without quotes is no cell of its own") {
  for (const bool first : {true, false}) {
    std::string text = first ? "date,x\n" : "x,date\n";
    for (int i = 0; i < 300; ++i) {
      const std::string date = fmt::format("Sun, 22 Nov 2026 12:{:02}:{:02} +0000", i / 60, i % 60);
      text += first ? fmt::format("{},{}\n", date, i % 7) : fmt::format("{},{}\n", i % 7, date);
    }
    const Recording r = test::read_text(text);
    CHECK(r.info.time.rate_hz == Approx(1).epsilon(1e-9));
    CHECK(r.info.time.start_ns.value_or(0) == 1795348800 * kBillion);
    REQUIRE(r.info.channels.size() == 1);
    CHECK(r.samples[0][8] == 1);
  }
}

TEST_CASE("stamps in a column for each of their numbers are read as one") {
  struct Spread {
    std::string header;
    const char* form;  ///< of year, month, day, hour, minute, second, millisecond, day of the year
    int step_ms;
  };
  for (const Spread& one :
       std::vector<Spread>{{"year,month,day,hour,minute,second", "{0},{1},{2},{3},{4},{5}", 1000},
                           {"Year,Month,Day,Hour,Minutes,Seconds", "{0},{1:02},{2:02},{3:02},{4:02},{5}.{6:03}", 20},
                           {"YYYY,MM,DD,hh,mm,ss", "{0},{1},{2},{3},{4},{5}", 1000},
                           {"#YY,MM,DD,hh,mm", "{0},{1},{2},{3},{4}", 600000},
                           {"day,month,year,hour,min,sec,ms", "{2},{1},{0},{3},{4},{5},{6}", 20},
                           {"utc_year,utc_month,utc_day,utc_hour", "{0},{1},{2},{3}", 3600000},
                           {"Jahr,Monat,Tag,Stunde,Minute,Sekunde", "{0},{1},{2},{3},{4},{5}", 1000},
                           {"year,day,hhmm", "{0},{7},{3}{4:02}", 60000},
                           {"year,doy,hour,minute", "{0},{7},{3},{4}", 60000},
                           {"date,hour", "{0}-{1:02}-{2:02},{3}", 3600000},
                           {"Date,Hour,Minute", "{1}/{2}/{0},{3},{4}", 60000},
                           {"h,m,s,ms", "{3},{4},{5},{6}", 20}}) {
    INFO(one.header);
    std::string text = one.header + ",x\n";
    for (int i = 0; i < 600; ++i) {
      const int s = i * (one.step_ms / 20) / 50, hours = s / 3600, day = 22 + hours / 24;
      text += fmt::format(fmt::runtime(one.form), 2026, day > 31 ? 11 : 10, day > 31 ? day - 31 : day, hours % 24,
                          s / 60 % 60, s % 60, i * one.step_ms % 1000, 273 + day) +
              fmt::format(",{}\n", i % 7);
      if (day > 50) break;
    }
    const Recording r = test::read_text(text);
    CHECK(r.info.time.rate_hz == Approx(1e3 / one.step_ms).epsilon(1e-6));
    CHECK(r.info.time.missing_samples == 0);
    REQUIRE(r.info.channels.size() == 1);
    CHECK(r.info.channels[0].name == "x");
    CHECK(r.samples[0][8] == 1);
    if (one.header[0] != 'h') CHECK(r.info.time.start_ns.value_or(0) == 1792627200 * kBillion);
  }
  // With a clock of their own, or numbers that are no dates, such columns are channels.
  std::string beside = "time,year,month,day,hour,x\n", others = "year,month,day,hour,x\n", huge = others;
  for (int i = 0; i < 100; ++i) {
    beside += fmt::format("{},2026,10,22,{},{}\n", i, i % 24, i % 7);
    others += fmt::format("{},{},{},{},{}\n", i, i % 40, i % 7, i, i % 7);
    huge += fmt::format("11700000000000000000,{},{},{},{}\n", i % 12, i % 7, i % 24, i % 7);  // beyond an int
  }
  CHECK(test::read_text(huge).info.channels.size() >= 4);
  CHECK(test::read_text(beside).info.channels.size() == 5);
  CHECK(test::read_text(others).info.channels.size() >= 4);
}

TEST_CASE("columns of dates without a year, in digits, and without names") {
  struct Spread {
    std::string head;  ///< lines in front; the last one names the columns, where it does not end the line
    const char* form;  ///< of year, month, day, hour, minute, second, day of the year, its date, hhmm, second of day
    int step_s;
    bool year = true;
  };
  const std::string preamble = " Station 7\n  40.05  -88.37  213 m version 1\n";
  for (const Spread& one : std::vector<Spread>{{"Month,Day,Hour,x", "{1},{2},{3}", 3600, false},
                                               {"doy,hhmm,x", "{6},{8}", 60, false},
                                               {"year,dayofyear,secofday,x", "{0},{6},{9}", 30},
                                               {"Year,DOY,sod,x", "{0},{6},{9}.000", 30},
                                               {"YYYYDDD,HHMM,x", "{7},{8:04}", 60},
                                               {"date,time,x", "{7},{8}", 60},
                                               {"Date,Time,x", "{0}{1:02}{2:02},{8}", 60},
                                               {"DATE,TIME,x", "{0}{1:02}{2:02},{8:04}", 60},
                                               {"Date,Time_(HHMM),x", "{1:02}/{2:02}/{0},{8:04}", 60},
                                               {preamble, " {0} {6:3} {1:2} {2:2} {3:2} {4:2} ", 60},
                                               {"94255\t2023\t1000\n", "{6}\t{8}\t", 60, false},
                                               {"", "{0},{6},{8}", 300},
                                               {"", "{0}{1:02}{2:02} {8:04}", 600},
                                               {"", "{0} {6} {3} {4}", 60}}) {
    INFO(one.head << one.form);
    const bool named = !one.head.empty() && !one.head.ends_with('\n');
    std::string text = one.head + (named ? "\n" : "");
    const char sign = named ? ',' : one.form[std::string_view(one.form).find_first_of(", \t", 3)];
    for (int i = 0; i < 800; ++i) {
      const int s = 79200 + i * one.step_s, of_year = 90 + s / 86400, hour = s / 3600 % 24, minute = s / 60 % 60;
      const int month = of_year > 120  ? 5
                        : of_year > 90 ? 4
                                       : 3,
                day = of_year - (month == 5   ? 120
                                 : month == 4 ? 90
                                              : 59);
      text += fmt::format(fmt::runtime(one.form), 2023, month, day, hour, minute, s % 60, of_year, 2023000 + of_year,
                          100 * hour + minute, s % 86400);
      text += fmt::format("{}{}.5\n", std::string_view(" \t").find(text.back()) == std::string_view::npos ? sign : ' ',
                          i % 7);
    }
    const Recording r = test::read_text(text);
    CHECK(r.info.time.rate_hz == Approx(1.0 / one.step_s).epsilon(1e-9));
    CHECK(r.info.time.missing_samples == 0);
    REQUIRE(r.info.channels.size() == 1);
    CHECK(r.samples[0][8] == 1.5);
    const std::int64_t start = 1680300000 + (one.year ? 0 : -694224000);  // the same day of 2001
    CHECK(r.info.time.start_ns.value_or(0) == start * kBillion);
  }
  std::string buoy = "#YY  MM DD hh mm WDIR WSPD\n#yr  mo dy hr mn degT m/s\n";
  for (int i = 0; i < 60; ++i)
    buoy += fmt::format("2023 05 {:02} {:02} 50 {} {}.5\n", 1 + i / 24, i % 24, 90 + i, i % 7);
  CHECK(test::read_text(buoy).info.channels[1].name == "WSPD");
  // Whole numbers that only look so are channels.
  std::string counts = "1 100 1.5\n";
  for (int i = 1; i < 100; ++i) counts += fmt::format("{} {} {}.5\n", 1 + i % 300, (i * 7) % 60, i % 7);
  CHECK(test::read_text(counts).info.channels.size() == 3);
  // A year ends.
  std::string year = "Month,Day,Hour,x\n";
  for (int i = 0; i < 96; ++i)
    year += fmt::format("{},{},{},1\n", i < 48 ? 12 : 1, i < 48 ? 30 + i / 24 : i / 24 - 1, i % 24);
  CHECK(test::read_text(year).info.time.missing_samples == 0);
}

TEST_CASE("dates in digits are read, in one column or in two, whatever they are called") {
  const auto tm_of = [](int second) {  // from 2024-03-14T23:40:12 on
    const int s = 85212 + second, day = 14 + s / 86400, of_day = s % 86400;
    return fmt::format("{}",
                       20240300000000 + day * 1000000LL + of_day / 3600 * 10000 + of_day / 60 % 60 * 100 + of_day % 60);
  };
  for (const int part : {0, 1, 2, 3, 4}) {
    std::string text = part == 0   ? "stamp,x\n"
                       : part == 1 ? "MESS_DATUM;x\n"
                       : part == 2 ? "DATE,TIME,x\n"
                       : part == 3 ? "timestamp,x\n"
                                   : "x,t\n";
    const int step = part == 1 ? 600 : 1;
    for (int i = 0; i < 2000; ++i) {
      const std::string t = tm_of(step * i);
      if (part == 0) text += fmt::format("{},{}\n", t, i % 7);
      if (part == 1) text += fmt::format("{};{}\n", t.substr(0, 12), i % 7);
      if (part == 2) text += fmt::format("{},{},{}\n", t.substr(0, 8), t.substr(8), i % 7);
      if (part == 3) text += fmt::format("{},{}\n", t.substr(2), i % 7);
      if (part == 4) text += fmt::format("{},{}.{}\n", i % 7, tm_of(i / 4), 25 * (i % 4));
    }
    INFO(text.substr(0, 60));
    const Recording r = test::read_text(text);
    CHECK(r.info.time.rate_hz == Approx(part == 1 ? 1.0 / 600 : part == 4 ? 4 : 1).epsilon(1e-6));
    CHECK(r.info.channels.size() == 1);
    CHECK(r.info.time.missing_samples == 0);
    CHECK(r.info.time.start_ns.value_or(0) / 60000000000 == 1710459612 / 60);
  }
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

TEST_CASE("seconds behind minutes are read where rows are missing") {
  std::string text;
  for (int i = 0, minute = 0; i < 300; ++i, minute += i % 3 == 0 ? 2 : 1)
    text += fmt::format("{} 2017 05 17 {:02} {:02} {} 30.{:03}\n", 900000 + 3 * i, 14 + minute / 60, minute % 60,
                        30 + i / 30, i % 97);
  CHECK(test::read_text(text).info.channels.size() == 2);
}
