// Days by std::chrono's proleptic Gregorian calendar; the forms are those of ISO 8601:2004 (4.2,
// 4.3) and of common exporters.

#include "libchar/log/time/calendar.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdlib>

#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr std::int64_t kSecondNs = 1000000000, kMinuteNs = 60 * kSecondNs, kHourNs = 60 * kMinuteNs,
                       kDayNs = 24 * kHourNs;

bool decimal_digit(char c) { return c >= '0' && c <= '9'; }

// A place in a text, moved on by what is taken.
struct DateScanner {
  std::string_view rest;

  char peek(std::size_t i = 0) const { return i < rest.size() ? rest[i] : '\0'; }
  bool take(char c) {
    if (peek() != c) return false;
    rest.remove_prefix(1);
    return true;
  }
  void blanks() {
    while (peek() == ' ') rest.remove_prefix(1);
  }
  std::size_t digits_ahead() const {
    std::size_t n = 0;
    while (decimal_digit(peek(n))) ++n;
    return n;
  }
  std::optional<int> number(std::size_t least, std::size_t most) {
    const std::size_t n = digits_ahead();
    if (n < least || n > most) return std::nullopt;
    return fixed(n);
  }
  int fixed(std::size_t n) {
    int value = 0;
    for (std::size_t i = 0; i < n; ++i) value = 10 * value + (rest[i] - '0');
    rest.remove_prefix(n);
    return value;
  }
  bool word(std::string_view wanted) {
    if (ascii_lower(rest.substr(0, wanted.size())) != wanted) return false;
    const char next = peek(wanted.size());
    if ((next >= 'a' && next <= 'z') || (next >= 'A' && next <= 'Z')) return false;
    rest.remove_prefix(wanted.size());
    return true;
  }
};

// 1…12 for a month as a word, in English; 0 for none.
int month_word(DateScanner& at) {
  static constexpr std::array<std::string_view, 12> kMonths = {"january",   "february", "march",    "april",
                                                               "may",       "june",     "july",     "august",
                                                               "september", "october",  "november", "december"};
  if (!std::isalpha(static_cast<unsigned char>(at.peek()))) return 0;
  for (std::size_t m = 0; m < kMonths.size(); ++m)
    if (at.word(kMonths[m]) || at.word(kMonths[m].substr(0, 3))) return static_cast<int>(m + 1);
  return 0;
}

std::optional<std::int64_t> days_of(int year, int month, int day) {
  const std::chrono::year_month_day date(std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day)));
  if (year < 1700 || year > 2200 || !date.ok()) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch().count();
}

int full_year(int year, std::size_t digits) {
  if (digits > 2) return year;
  return year < 70 ? 2000 + year : 1900 + year;
}

bool take_days(CalendarStamp& out, int year, int month, int day) {
  const auto days = days_of(year, month, day);
  if (!days) return false;
  out.ns = *days * kDayNs;
  out.date = true;
  return true;
}

// "01-May-2024", "1 May 2024", "May 1, 2024"
bool worded_date(DateScanner& at, CalendarStamp& out) {
  DateScanner s = at;
  int month = month_word(s), day = 0;
  const auto gap = [&] {
    while (s.peek() == ' ' || s.peek() == '-' || s.peek() == ',' || s.peek() == '/') s.rest.remove_prefix(1);
  };
  if (month > 0) {
    gap();
    const auto d = s.number(1, 2);
    if (!d) return false;
    day = *d;
  } else {
    const auto d = s.number(1, 2);
    if (!d) return false;
    day = *d;
    gap();
    month = month_word(s);
    if (month == 0) return false;
  }
  gap();
  const std::size_t n = s.digits_ahead();
  const auto year = s.number(2, 4);
  if (!year || !take_days(out, full_year(*year, n), month, day)) return false;
  at = s;
  return true;
}

// "20240501T…": without a clock it would be any number.
bool compact_date(DateScanner& at, CalendarStamp& out) {
  if (at.digits_ahead() != 8 || (at.peek(8) != 'T' && at.peek(8) != '_') || !decimal_digit(at.peek(9))) return false;
  const int year = at.fixed(4), month = at.fixed(2);
  return take_days(out, year, month, at.fixed(2));
}

bool numbered_date(DateScanner& at, DateOrder order, CalendarStamp& out) {
  DateScanner s = at;
  const std::size_t first_digits = s.digits_ahead();
  const auto first = s.number(1, 4);
  const char sign = s.peek();
  if (!first || (sign != '-' && sign != '/' && sign != '.') || first_digits == 3) return false;
  s.take(sign);
  const auto second = s.number(1, 2);
  if (!second || !s.take(sign)) return false;
  const std::size_t third_digits = s.digits_ahead();
  const auto third = s.number(1, 4);
  if (!third || third_digits == 3) return false;
  out.separator = sign;
  if (first_digits == 4) {
    if (!take_days(out, *first, *second, *third)) return false;
  } else {
    if (third_digits == 1) return false;
    out.order_said = false;
    out.first = *first;
    out.second = *second;
    const bool day = order == DateOrder::day_first;
    if (!take_days(out, full_year(*third, third_digits), day ? *second : *first, day ? *first : *second)) return false;
  }
  at = s;
  return true;
}

// Nanoseconds of the digits behind a decimal mark; the tenth digit rounds.
std::int64_t second_fraction(DateScanner& at) {
  std::int64_t ns = 0, unit = kSecondNs / 10;
  const std::size_t n = at.digits_ahead();
  for (std::size_t i = 0; i < n; ++i, unit /= 10) {
    ns += (at.rest[i] - '0') * unit;
    if (i == 9 && at.rest[i] >= '5') ++ns;
  }
  at.rest.remove_prefix(n);
  return ns;
}

// "12:00", "12:00:00.123", "12:00:00:123", "3:04:05 PM", "120000.5", and "59:58.0" without an hour
bool clock_time(DateScanner& at, CalendarStamp& out) {
  DateScanner s = at;
  const bool compact = out.date && (s.digits_ahead() == 6 || s.digits_ahead() == 4);
  const bool with_seconds = s.digits_ahead() == 6;
  const auto hour = compact ? std::optional(s.fixed(2)) : s.number(1, 2);
  if (!hour || (!compact && !s.take(':'))) return false;
  const auto minute = compact ? std::optional(s.fixed(2)) : s.number(2, 2);
  if (!minute) return false;
  int second = 0;
  std::int64_t part = 0;
  if (!compact && !out.date && (s.peek() == '.' || s.peek() == ',') && decimal_digit(s.peek(1))) {
    s.rest.remove_prefix(1);
    out.of_hour = out.clock = true;
    out.ns = *hour * kMinuteNs + *minute * kSecondNs + second_fraction(s);
    at = s;
    return *hour < 60 && *minute < 60;
  }
  if (compact ? with_seconds : s.peek() == ':') {
    if (!compact) s.take(':');
    if (s.digits_ahead() < 2 || (!compact && s.digits_ahead() > 2)) return false;
    second = s.fixed(2);
    if ((s.peek() == '.' || s.peek() == ',' || s.peek() == ':') && decimal_digit(s.peek(1))) {
      s.rest.remove_prefix(1);
      part = second_fraction(s);
    }
  }
  int hours = *hour;
  DateScanner half = s;
  half.blanks();
  const bool morning = half.word("am") || half.word("a.m."),
             evening = !morning && (half.word("pm") || half.word("p.m."));
  if (morning || evening) {
    if (hours < 1 || hours > 12) return false;
    hours = hours % 12 + (evening ? 12 : 0);
    out.half_days = true;
    s = half;
  }
  if (hours > 24 || *minute > 59 || second > 60 || (hours == 24 && (*minute > 0 || second > 0))) return false;
  out.ns += hours * kHourNs + *minute * kMinuteNs + second * kSecondNs + part;
  out.clock = true;
  at = s;
  return true;
}

// "Z", "UTC", "+02:00", "-0730", "GMT+2"
bool take_zone(DateScanner& at, CalendarStamp& out) {
  at.blanks();
  if (at.rest.empty()) return true;
  const bool named = at.word("z") || at.word("utc") || at.word("gmt");
  out.zone = named;
  if (at.peek() == '+' || at.peek() == '-') {
    const bool west = at.peek() == '-';
    at.rest.remove_prefix(1);
    const std::size_t n = at.digits_ahead();
    if (n == 0 || n > 4 || n == 3 || (n == 1 && !named)) return false;
    const int hours = at.fixed(n > 2 ? 2 : n);
    int minutes = 0;
    if (n == 4)
      minutes = at.fixed(2);
    else if (at.take(':')) {
      const auto m = at.number(2, 2);
      if (!m) return false;
      minutes = *m;
    }
    if (hours > 18 || minutes > 59) return false;
    const std::int64_t offset = hours * kHourNs + minutes * kMinuteNs;
    out.ns += west ? offset : -offset;
    out.zone = true;
  }
  at.blanks();
  return at.rest.empty();
}

}  // namespace

std::optional<CalendarStamp> read_calendar(std::string_view text, DateOrder order) {
  DateScanner at{text};
  at.blanks();
  CalendarStamp out;
  constexpr std::size_t kShortest = 4, kLongest = 64;
  if (at.rest.size() < kShortest || at.rest.size() > kLongest ||
      std::none_of(at.rest.begin(), at.rest.end(), decimal_digit))
    return std::nullopt;
  const bool dated = compact_date(at, out) || numbered_date(at, order, out) || worded_date(at, out);
  if (dated) {
    if (!at.take('T') && !at.take('_')) {
      at.take(',');
      at.blanks();
    }
    if (at.rest.empty()) return out;
  }
  if (!clock_time(at, out) || !take_zone(at, out)) return std::nullopt;
  return out;
}

namespace {

/// The longest step between two stamps of a log, either way.
std::int64_t longest_step(const std::vector<std::string_view>& texts, DateOrder order) {
  std::int64_t longest = 0;
  std::optional<std::int64_t> last;
  for (const std::string_view text : texts)
    if (const auto stamp = read_calendar(text, order)) {
      if (last) longest = std::max(longest, std::abs(stamp->ns - *last));
      last = stamp->ns;
    }
  return longest;
}

}  // namespace

DateStyle date_style(const std::vector<std::string_view>& texts, bool european) {
  bool point = false, american = false, seen = false;
  for (const std::string_view text : texts)
    for (const DateOrder order : {DateOrder::day_first, DateOrder::month_first}) {
      const auto stamp = read_calendar(text, order);
      if (!stamp || !stamp->date || stamp->order_said) continue;
      if (stamp->first > 12) return {DateOrder::day_first, false};
      if (stamp->second > 12) return {DateOrder::month_first, false};
      seen = true;
      point = point || stamp->separator == '.';
      american = american || stamp->half_days || stamp->separator == '/';
    }
  if (!seen) return {};
  const std::int64_t by_day = longest_step(texts, DateOrder::day_first),
                     by_month = longest_step(texts, DateOrder::month_first);
  if (by_day < by_month / 4) return {DateOrder::day_first, true};
  if (by_month < by_day / 4) return {DateOrder::month_first, true};
  if (point) return {DateOrder::day_first, false};
  return {american && !european ? DateOrder::month_first : DateOrder::day_first, true};
}

}  // namespace libchar
