// Days by std::chrono's proleptic Gregorian calendar; the forms are those of ISO 8601:2004 (4.2,
// 4.3) and of common exporters.

#include "libchar/log/time/calendar.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "libchar/core/numeric/whole.hpp"
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
  bool begins(std::string_view lower) const {
    if (rest.size() < lower.size()) return false;
    for (std::size_t i = 0; i < lower.size(); ++i)
      if ((rest[i] >= 'A' && rest[i] <= 'Z' ? rest[i] - 'A' + 'a' : rest[i]) != lower[i]) return false;
    return true;
  }
  bool word(std::string_view wanted) {
    if (!begins(wanted)) return false;
    const char next = peek(wanted.size());
    if ((next >= 'a' && next <= 'z') || (next >= 'A' && next <= 'Z')) return false;
    rest.remove_prefix(wanted.size());
    return true;
  }
};

// What stands behind a number instead of a sign, in the languages of East Asia and in French.
struct StampWord {
  std::string_view text;
  char sign;
  bool latin = false;  // no letter stands behind it
};
constexpr StampWord kStampWords[] = {{"年", '-'},        {"月", '-'},      {"日", ' '},        {"时", ':'},
                                     {"時", ':'},        {"点", ':'},      {"點", ':'},        {"分", ':'},
                                     {"秒", ' '},        {"년", '-'},      {"월", '-'},        {"일", ' '},
                                     {"시", ':'},        {"분", ':'},      {"초", ' '},        {"h", ':', true},
                                     {"min", ':', true}, {"m", ':', true}, {"sec", ' ', true}, {"s", ' ', true}};
constexpr std::pair<std::string_view, std::string_view> kHalves[] = {{"上午", " am"}, {"下午", " pm"}, {"午前", " am"},
                                                                     {"午後", " pm"}, {"오전", " am"}, {"오후", " pm"}};

bool ascii_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

const StampWord* stamp_word(std::string_view text) {
  for (const StampWord& word : kStampWords)
    if (text.starts_with(word.text) &&
        !(word.latin && text.size() > word.text.size() && ascii_letter(text[word.text.size()])))
      return &word;
  return nullptr;
}

// "2024年3月5日 上午 10時05分07秒" and "10 h 05 min" with signs, "2024-3-5 10:05:07 am"; nothing where none of these words
// stands in the text.
std::optional<std::string> with_signs(std::string_view text) {
  const bool worded = std::any_of(text.begin(), text.end(), [](char c) { return (c & 0x80) != 0 || c == 'h'; });
  if (!worded) return std::nullopt;
  std::string out;
  std::string_view half;
  bool found = false, hour = false;
  const auto end_with = [&](std::string_view signs) {
    while (!out.empty() && signs.find(out.back()) != signs.npos) out.pop_back();
  };
  while (!text.empty()) {
    const auto* const is_half = std::find_if(std::begin(kHalves), std::end(kHalves),
                                             [&](const auto& one) { return text.starts_with(one.first); });
    const std::size_t digit = out.find_last_not_of(' ');
    const StampWord* const word = digit != out.npos && decimal_digit(out[digit]) ? stamp_word(text) : nullptr;
    if (is_half != std::end(kHalves)) {
      half = is_half->second;
      text.remove_prefix(is_half->first.size());
    } else if (word != nullptr && (!word->latin || word->text == "h" || hour)) {
      end_with(" ");
      const bool fraction =
          word->sign == ' ' && word->text.size() < text.size() && decimal_digit(text[word->text.size()]);
      out += fraction ? '.' : word->sign;  // "23h40m05s250"
      hour = hour || word->sign == ':';
      text.remove_prefix(word->text.size());
    } else {
      if (text[0] != ' ' || (!out.empty() && out.back() != ':' && out.back() != '-')) out += text[0];
      text.remove_prefix(1);
      continue;
    }
    found = true;
  }
  if (!found) return std::nullopt;
  end_with(" :-");
  return out.append(half);
}

// 1…12 for a month as a word, in English, German, French or Spanish; 0 for none.
int month_word(DateScanner& at) {
  static constexpr std::array<std::string_view, 12> kOthers = {"januar|j\u00E4n|janv|janvier|ene|enero",
                                                               "februar|f\u00E9vr|fevr|febrero|f\u00E9vrier",
                                                               "m\u00E4rz|m\u00E4r|maerz|mrz|mars|marzo",
                                                               "avr|avril|abr|abril",
                                                               "mai|mayo",
                                                               "juni|juin|junio",
                                                               "juli|juil|juillet|julio",
                                                               "ao\u00FBt|aout|ago|agosto",
                                                               "sept|septembre|septiembre",
                                                               "okt|oktober|octobre|octubre",
                                                               "novembre|noviembre",
                                                               "dez|dezember|d\u00E9c|d\u00E9cembre|dic|diciembre"};
  static constexpr std::array<std::string_view, 12> kMonths = {"january",   "february", "march",    "april",
                                                               "may",       "june",     "july",     "august",
                                                               "september", "october",  "november", "december"};
  if (!std::isalpha(static_cast<unsigned char>(at.peek()))) return 0;
  for (std::size_t m = 0; m < kMonths.size(); ++m)
    if (at.word(kMonths[m]) || at.word(kMonths[m].substr(0, 3))) return static_cast<int>(m + 1);
  for (std::size_t m = 0; m < kOthers.size(); ++m)
    for (std::string_view rest = kOthers[m]; !rest.empty();) {
      const std::size_t bar = std::min(rest.find('|'), rest.size());
      if (at.word(rest.substr(0, bar))) return static_cast<int>(m + 1);
      rest.remove_prefix(std::min(bar + 1, rest.size()));
    }
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

// "Wed", "Wednesday," in front of a date, which they do not change.
void skip_weekday(DateScanner& at) {
  for (const std::string_view day : {"mon", "tue", "wed", "thu", "fri", "sat", "sun"})
    if (at.begins(day)) {
      while (std::isalpha(static_cast<unsigned char>(at.peek()))) at.rest.remove_prefix(1);
      at.take(',');
      at.blanks();
    }
}

// The year behind the clock, "12:00:00 2024"; taken off the end.
std::optional<int> year_at_the_end(DateScanner& at) {
  const std::size_t blank = at.rest.rfind(' ');
  DateScanner year{at.rest.substr(std::min(blank, at.rest.size()))};
  year.blanks();
  const auto number = year.number(4, 4);
  if (number && year.rest.empty()) at.rest = at.rest.substr(0, blank);
  return number;
}

// "01-May-2024", "1 May 2024", "1. Mai 2024", "May 1, 2024", "May 1 12:00:00 2024"
bool worded_date(DateScanner& at, CalendarStamp& out) {
  DateScanner s = at;
  int month = month_word(s), day = 0;
  const auto gap = [&] {
    while (s.peek() != '\0' && std::string_view(" -,/.").find(s.peek()) != std::string_view::npos)
      s.rest.remove_prefix(1);
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
  const auto year = n < 3 && s.peek(n) == ':' ? year_at_the_end(s) : s.number(2, 4);
  if (!year || !take_days(out, full_year(*year, n < 3 && *year > 99 ? 4 : n), month, day)) return false;
  at = s;
  return true;
}

// "20240501T…", "20240501:0010": without a clock it would be any number.
bool compact_date(DateScanner& at, CalendarStamp& out) {
  if (at.digits_ahead() != 8 || (at.peek(8) != 'T' && at.peek(8) != '_' && at.peek(8) != ':') ||
      !decimal_digit(at.peek(9)))
    return false;
  const int year = at.fixed(4), month = at.fixed(2);
  return take_days(out, year, month, at.fixed(2));
}

bool numbered_date(DateScanner& at, DateOrder order, CalendarStamp& out) {
  DateScanner s = at;
  const std::size_t first_digits = s.digits_ahead();
  const auto first = s.number(1, 4);
  const char sign = s.peek();
  const bool known = sign == '-' || sign == '/' || sign == '.' || ((sign == ':' || sign == '_') && first_digits == 4);
  if (!first || !known || first_digits == 3) return false;
  s.take(sign);
  if (first_digits == 4 && s.digits_ahead() == 3) {  // the day of the year
    const int day = s.fixed(3);
    if (s.rest.empty() || day < 1 || day > 366 || !take_days(out, *first, 1, 1)) return false;
    out.ns += (day - 1) * kDayNs;
    at = s;
    return true;
  }
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
    out.short_year = third_digits == 2;
    const bool day = order == DateOrder::day_first;
    const bool good =
        order == DateOrder::year_first
            ? out.short_year && take_days(out, full_year(*first, 2), *second, *third)
            : take_days(out, full_year(*third, third_digits), day ? *second : *first, day ? *first : *second);
    if (!good) return false;
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

// What stands behind whole seconds: ".123", ":123", ".123,456" of Zephyr and ".123.456", "-123" and "_123456" of the
// names of files.
std::int64_t behind_seconds(DateScanner& at) {
  const char sign = at.peek();
  const bool digits = decimal_digit(at.peek(1));
  DateScanner s{at.rest.substr(std::min<std::size_t>(1, at.rest.size()))};
  const std::size_t n = s.digits_ahead();
  const bool of_a_name = (sign == '-' || sign == '_') && (n == 3 || n == 6) && s.rest.size() == n;
  if (!digits || (sign != '.' && sign != ',' && sign != ':' && !of_a_name)) return 0;
  std::int64_t part = second_fraction(s);
  if (DateScanner more = s; n == 3 && (more.take(',') || more.take('.')) && more.digits_ahead() == 3) {
    part += more.fixed(3) * 1000;
    s = more;
  }
  at = s;
  return part;
}

// "12:00", "12:00:00.123", "12:00:00:123", "12-00-00", "12_00_00", "3:04:05 PM", "120000.5", "49:03:04" of what ran
// for days, and "59:58.0" and "35:10" without an hour
bool clock_time(DateScanner& at, CalendarStamp& out) {
  DateScanner s = at;
  const std::size_t digits = s.digits_ahead();
  const bool fraction = digits == 9 || digits == 12;  // "20240501_120000123456" of %f
  const bool with_seconds = digits == 6 || fraction, compact = out.date && (digits == 4 || with_seconds);
  const auto hour = compact ? std::optional(s.fixed(2)) : s.number(1, out.date ? 2 : 4);
  const char sign = out.date && (s.peek() == '-' || s.peek() == '_') ? s.peek() : ':';
  if (!hour || (!compact && !s.take(sign))) return false;
  const bool padded = s.digits_ahead() == 2 || s.peek(1) != ':';  // printf("%d:%d:%d")
  const auto minute = compact ? std::optional(s.fixed(2)) : s.number(padded ? 2 : 1, 2);
  if (!minute) return false;
  int second = 0;
  std::int64_t part = 0;
  if (!compact && !out.date && (s.peek() == '.' || s.peek() == ',') && decimal_digit(s.peek(1))) {
    s.rest.remove_prefix(1);
    out.of_hour = out.clock = true;
    out.ns = *hour * kMinuteNs + *minute * kSecondNs + second_fraction(s);
    at = s;
    return *minute < 60;
  }
  out.seconds = compact ? with_seconds : s.peek() == sign;
  if (out.seconds) {
    if (!compact) s.take(sign);
    const std::size_t n = s.digits_ahead();
    if (n == 0 || (!compact && n > 2)) return false;
    second = s.fixed(std::min<std::size_t>(n, 2));
    const std::size_t before = s.rest.size();
    part = compact && fraction ? second_fraction(s) : behind_seconds(s);
    out.fraction_digits = compact || s.rest.size() == before ? 0 : before - s.rest.size() - 1;
    out.fraction_ns = part;
  }
  int hours = *hour;
  DateScanner half = s;
  half.blanks();
  const bool morning = half.word("am") || half.word("a.m."),
             evening = !morning && (half.word("pm") || half.word("p.m."));
  if (morning || evening) {
    if (hours > 12) return false;
    hours = hours % 12 + (evening ? 12 : 0);
    out.half_days = true;
    s = half;
  }
  const bool beyond = hours > 24 || (hours == 24 && (*minute > 0 || second > 0));
  if (*minute > 59 || second > 60 || (beyond && (out.date || out.ns > 0))) return false;
  out.of_hour = beyond && !out.seconds;
  out.ns += out.of_hour ? hours * kMinuteNs + *minute * kSecondNs
                        : hours * kHourNs + *minute * kMinuteNs + second * kSecondNs + part;
  out.clock = true;
  at = s;
  return true;
}

// "Z", "UTC", "+02:00", "-0730", "GMT+2", "+02:00[Europe/Berlin]"
bool take_zone(DateScanner& at, CalendarStamp& out) {
  if (const std::size_t name = at.rest.find('['); at.rest.ends_with(']')) at.rest = at.rest.substr(0, name);
  const bool apart = at.peek() == ' ';  // "12:00:00 -10" has a number behind it
  at.blanks();
  if (at.rest.empty()) return true;
  const bool named = at.word("z") || at.word("utc") || at.word("gmt");
  out.zone = named;
  if (at.peek() == '+' || at.peek() == '-') {
    const bool west = at.peek() == '-';
    at.rest.remove_prefix(1);
    const std::size_t n = at.digits_ahead();
    if (n == 0 || n > 4 || n == 3 || (!named && (n == 1 || (apart && n == 2 && at.peek(n) != ':')))) return false;
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
  // "CAT", "AEST": of a zone's letters nobody knows the hours, and all stamps of a log have them.
  constexpr std::size_t kFewestLetters = 3, kMostLetters = 4;
  const bool letters = !named && out.seconds && at.rest.ends_with('T') && at.rest.size() >= kFewestLetters &&
                       at.rest.size() <= kMostLetters &&
                       std::all_of(at.rest.begin(), at.rest.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  return at.rest.empty() || (apart && letters);
}

// "0 days 00:00:01.5", "1 day, 2:03:04", "1d 02:03:04", "1 02:03:04", "1.02:03:04": what pandas, Python and .NET write.
void whole_days(DateScanner& at, CalendarStamp& out) {
  DateScanner s = at;
  const auto days = s.number(1, 5);
  if (!days) return;
  const bool sign = s.peek() == '.' || s.peek() == ' ';
  if (!s.take('.')) s.blanks();
  const bool word = s.word("days") || s.word("day") || s.word("d");
  if (word) s.take(',');
  s.blanks();
  DateScanner clock = s;
  if (!word && (!sign || !clock.number(1, 2) || !clock.take(':') || !clock.number(2, 2) || !clock.take(':'))) return;
  out.ns = *days * kDayNs;
  at = s;
}

// "PT12.5S", "P0DT00H01M02.5S": a duration of ISO 8601, without years, months and weeks.
std::optional<CalendarStamp> duration(std::string_view text) {
  DateScanner at{text};
  CalendarStamp out;
  const auto part = [&](char sign, std::size_t digits, std::int64_t unit) {
    DateScanner s = at;
    const auto number = s.number(1, digits);
    const std::int64_t behind = number && sign == 'S' ? behind_seconds(s) : 0;
    if (!number || !s.take(sign)) return;
    out.ns += *number * unit + behind;
    out.clock = out.seconds = true;
    at = s;
  };
  if (!at.take('P')) return std::nullopt;
  part('D', 4, kDayNs);
  if (!at.take('T')) return std::nullopt;
  out.clock = false;  // something stands behind the T
  part('H', 5, kHourNs);
  part('M', 7, kMinuteNs);
  part('S', 9, kSecondNs);
  return at.rest.empty() && out.clock ? std::optional(out) : std::nullopt;
}

// "11:47:22 07/04/2014": the date behind the clock, which `at` has taken of the text.
std::optional<CalendarStamp> date_behind(DateScanner at, std::string_view text, DateOrder order) {
  const std::string_view clock = text.substr(0, text.size() - at.rest.size());
  at.blanks();
  const std::string_view date = at.rest;
  CalendarStamp day;
  if (at.peek() < '0' || at.peek() > '9' || !numbered_date(at, order, day) || !at.rest.empty()) return std::nullopt;
  return read_calendar(std::string(date) + " " + std::string(clock), order);
}

// "12-00-05-250" and "12_00_05.250": a clock time between the signs of a file's name, with its fraction.
std::optional<CalendarStamp> dashed_clock(std::string_view text) {
  constexpr std::size_t kShortest = 12, kMinute = 2, kSecond = 5, kMark = 8;
  if (text.size() < kShortest || (text[kMinute] != '-' && text[kMinute] != '_') || text[kSecond] != text[kMinute] ||
      (text[kMark] != text[kMinute] && text[kMark] != '.' && text[kMark] != ','))
    return std::nullopt;
  std::string clock(text);
  clock[kMinute] = clock[kSecond] = ':';
  clock[kMark] = '.';
  CalendarStamp out;
  DateScanner at{clock};
  return clock_time(at, out) && at.rest.empty() ? std::optional(out) : std::nullopt;
}

}  // namespace

std::optional<Elapsed> read_elapsed(std::string_view text) {
  static constexpr std::pair<std::string_view, double> kParts[] = {
      {"h", 3600e9}, {"m", 60e9}, {"s", 1e9}, {"ms", 1e6}, {"\u00B5s", 1e3}, {"us", 1e3}, {"ns", 1}};
  Elapsed out;
  if (!text.ends_with('s')) return std::nullopt;
  const bool minus = text.starts_with('-');
  DateScanner at{text.substr(minus ? 1 : 0)};
  double ns = 0;
  const auto* part = std::begin(kParts);
  while (!at.rest.empty()) {
    constexpr std::size_t kMost = 15;
    const std::size_t digits = at.digits_ahead();
    if (digits == 0 || digits > kMost) return std::nullopt;
    double whole = 0;
    for (const char c : at.rest.substr(0, digits)) whole = 10 * whole + (c - '0');
    at.rest.remove_prefix(digits);
    const bool mark = at.take('.');
    if (mark && at.digits_ahead() == 0) return std::nullopt;
    const double behind = mark ? static_cast<double>(second_fraction(at)) * 1e-9 : 0;
    const std::string_view unit = at.rest.substr(0, std::min(at.rest.find_first_of("0123456789"), at.rest.size()));
    part = std::find_if(part, std::end(kParts), [&](const auto& one) { return one.first == unit; });
    if (part == std::end(kParts)) return std::nullopt;
    ns += whole * part->second + behind * part->second;
    at.rest.remove_prefix(unit.size());
    ++part;
    ++out.parts;
  }
  if (out.parts == 0 || ns > 9e18) return std::nullopt;
  out.ns = clamped_whole<std::int64_t>(std::round(minus ? -ns : ns));
  return out;
}

std::optional<CalendarStamp> read_calendar(std::string_view text, DateOrder order) {
  if (const auto clock = dashed_clock(text)) return clock;
  if (const auto elapsed = read_elapsed(text); elapsed && elapsed->parts > 1 && elapsed->ns >= 0) {
    CalendarStamp out;
    out.ns = elapsed->ns;
    out.clock = out.seconds = true;
    return out;
  }
  if (const auto plain = with_signs(text)) return read_calendar(*plain, order);
  // "2024-05-01T12:00:00/2024-05-01T12:01:00" of ISO 8601: an interval, by its beginning
  if (const std::size_t slash = text.find('/'); slash != text.npos && text.substr(0, slash).find('T') != text.npos) {
    const auto from = read_calendar(text.substr(0, slash), order), to = read_calendar(text.substr(slash + 1), order);
    return from && to && from->date && to->date && from->ns <= to->ns ? from : std::nullopt;
  }
  DateScanner at{text};
  at.blanks();
  CalendarStamp out;
  constexpr std::size_t kShortest = 4, kLongest = 64;
  if (at.rest.size() < kShortest || at.rest.size() > kLongest ||
      std::none_of(at.rest.begin(), at.rest.end(), decimal_digit))
    return std::nullopt;
  if (at.peek() == 'P') return duration(at.rest);
  skip_weekday(at);
  const bool dated = compact_date(at, out) || numbered_date(at, order, out) || worded_date(at, out);
  if (dated) {
    if (!at.take('T') && !at.take('_') && !at.take('-') && !at.take(':')) {
      at.take(',');
      at.blanks();
    }
    if (at.rest.empty()) return out;
  }
  if (!dated) whole_days(at, out);
  if (!clock_time(at, out)) return std::nullopt;
  if (const auto behind = dated ? std::nullopt : date_behind(at, text, order)) return behind;
  if (!take_zone(at, out)) return std::nullopt;
  return out;
}

std::optional<CalendarStamp> read_calendar(std::string_view text) {
  // Next to all cells are numbers, which need no further look.
  const auto sign = [](char c) { return c == '-' || c == '/' || c == '.'; };
  const auto clock = [](char c) { return c == ':' || c == ',' || c == '_' || (c & 0x80) != 0 || ascii_letter(c); };
  if (std::none_of(text.begin(), text.end(), clock) && std::count_if(text.begin(), text.end(), sign) < 2)
    return std::nullopt;
  if (std::none_of(text.begin(), text.end(), decimal_digit)) return std::nullopt;  // words
  if (const auto stamp = read_calendar(text, DateOrder::day_first)) return stamp;
  const auto twice = [&](char c) { return std::count(text.begin(), text.end(), c) > 1; };
  if (!twice('-') && !twice('/') && !twice('.')) return std::nullopt;  // no date whose order is not said
  for (const DateOrder order : {DateOrder::month_first, DateOrder::year_first})
    if (const auto stamp = read_calendar(text, order)) return stamp;
  return std::nullopt;
}

std::optional<CalendarStamp> read_date_digits(std::string_view text) {
  constexpr std::size_t kDate = 8, kHour = 10, kMinute = 12, kSecond = 14;
  const std::size_t n = DateScanner{text}.digits_ahead();
  if ((n != kDate && n != kHour && n != kMinute && n != kSecond) || (n < kMinute && n < text.size()))
    return std::nullopt;
  const std::string date(text.substr(0, kDate));
  if (n == kDate) return read_calendar(date.substr(0, 4) + "-" + date.substr(4, 2) + "-" + date.substr(6));
  std::string clock(text.substr(kDate));
  if (n == kHour) clock += "00";
  const auto stamp = read_calendar(date + "T" + clock, DateOrder::day_first);
  if (stamp || n != kMinute) return stamp;
  return read_calendar("20" + date.substr(0, 6) + "T" + std::string(text.substr(6)), DateOrder::day_first);
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
  bool point = false, american = false, seen = false, rare = false;  // "24/05/01" with the year first
  std::vector<DateOrder> could_be = {DateOrder::day_first, DateOrder::month_first, DateOrder::year_first};
  const auto not_so = [&](DateOrder order) { std::erase(could_be, order); };
  for (const std::string_view text : texts) {
    const auto stamp = read_calendar(text);
    if (!stamp || !stamp->date || stamp->order_said) continue;
    const bool could = stamp->short_year && (stamp->separator != '.' || stamp->first > 31);
    if (!could && could_be.size() > 1) not_so(DateOrder::year_first);  // unless another text had a year there
    rare = rare || (stamp->separator == '/' && stamp->first <= 31);
    for (const DateOrder order : {DateOrder::day_first, DateOrder::month_first, DateOrder::year_first})
      if (could_be.size() > 1 && !read_calendar(text, order)) not_so(order);
    seen = true;
    point = point || stamp->separator == '.';
    american = american || stamp->half_days || stamp->separator == '/';
  }
  if (!seen) return {};
  if (could_be.size() == 1) return {could_be.front(), false};
  std::vector<std::int64_t> steps;
  for (const DateOrder order : could_be) steps.push_back(longest_step(texts, order));
  const auto least = std::min_element(steps.begin(), steps.end());
  const auto longer = std::count_if(steps.begin(), steps.end(), [&](std::int64_t step) { return *least < step / 4; });
  if (static_cast<std::size_t>(longer) + 1 == steps.size())
    return {could_be[static_cast<std::size_t>(least - steps.begin())], true};
  if (rare && could_be.back() == DateOrder::year_first) could_be.pop_back();
  if (could_be.size() == 1) return {could_be.front(), true};
  const bool day = could_be.front() == DateOrder::day_first;
  if (day && point) return {DateOrder::day_first, false};
  const bool month = day && american && !european && could_be[1] == DateOrder::month_first;
  return {month ? DateOrder::month_first : could_be.front(), true};
}

}  // namespace libchar
