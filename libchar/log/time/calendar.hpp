#pragma once
// Dates and clock times as they are written in logs, to whole nanoseconds: ISO 8601 and what spreadsheets, data loggers
// and terminals write. Days are those of the Gregorian calendar, counted from 1970-01-01.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace libchar {

/// Which number of a date stands first, where its signs do not say so (05/01/2024, 24-05-01).
enum class DateOrder : std::uint8_t { day_first, month_first, year_first };

struct CalendarStamp {
  std::int64_t ns = 0;  ///< since 1970, or since midnight where there is no date; in UTC where a zone is written
  bool date = false, clock = false, zone = false;
  bool order_said = true;           ///< the year stands first, or the month is a word
  bool half_days = false;           ///< AM or PM is written
  bool of_hour = false;             ///< minutes and seconds alone, "59:58.0", "35:10"
  bool seconds = false;             ///< behind hours and minutes
  char separator = 0;               ///< between the numbers of the date, 0 for none
  int first = 0, second = 0;        ///< of a date whose order is not said
  bool short_year = false;          ///< and whose year has two digits
  std::size_t fraction_digits = 0;  ///< behind the seconds
  std::int64_t fraction_ns = 0;     ///< read as a fraction
};

/// The whole of `text` as "2024-05-01T12:00:00.123456789+02:00", "01.05.2024 12:00:00", "5/1/24 3:04 PM",
/// "01-May-2024 12:00", "Wed May 1 12:00:00 2024", "2024-122T12:00:00", "20240501T120000Z", "23h40m05s",
/// "12-00-05-250", with the words of Chinese, Japanese and Korean for year, month, day, hour, minute and second, a
/// date or a clock time alone, or one with days in front ("1 day, 2:03:04", "1.02:03:04", "49:03:04",
/// "P2DT1H3M4.5S"). Fractions are rounded to the nanosecond. Nothing when it is none of these, or no day of the
/// calendar.
std::optional<CalendarStamp> read_calendar(std::string_view text, DateOrder order);
/// The same in the first order in which it is a date.
std::optional<CalendarStamp> read_calendar(std::string_view text);

/// "1m2.5s", "250ms", "1h0m0s": a time as Go prints it, from the largest part to the smallest.
struct Elapsed {
  std::int64_t ns = 0;
  int parts = 0;
};
std::optional<Elapsed> read_elapsed(std::string_view text);

/// Digits alone: "20240501120000.25", "202405011200", "2024050112", "20240501", and "240501120000".
std::optional<CalendarStamp> read_date_digits(std::string_view text);

/// How the dates of a log are written.
struct DateStyle {
  DateOrder order = DateOrder::day_first;
  bool ambiguous = false;  ///< could be either: a guess
};

/// From the first stamps: a number above 12 decides, then the order in which no two of them lie apart by
/// more than four times as far as in the other one, then the signs ('.' is European, AM and PM and '/' American).
/// `european` is what else the log looks like (decimal commas).
DateStyle date_style(const std::vector<std::string_view>& texts, bool european);

}  // namespace libchar
