#include "libchar/core/text/quantity_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/double_text.hpp"

namespace libchar {
namespace {

using Units = std::initializer_list<std::pair<std::string_view, double>>;

[[noreturn]] void refuse(std::string_view text, const std::string& expected) {
  throw usage_error("E0201").says("expected " + expected).got(std::string(text));
}

bool may_follow(char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; }

// A decimal number as one writes it: "+5" and "5." are fine, "010" is not (eight or ten?), nor "nan", "inf", "0x10".
std::pair<double, std::string_view> leading_number(std::string_view text, const std::string& expected) {
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  const std::string_view magnitude = digits.starts_with('-') ? digits.substr(1) : digits;
  const bool octal_looking = magnitude.size() > 1 && magnitude[0] == '0' && magnitude[1] >= '0' && magnitude[1] <= '9';
  if (digits.empty() || !may_follow(digits[0]) || octal_looking || text.starts_with("+-")) refuse(text, expected);
  double value = 0;
  const auto [end, status] = detail::read_double(digits.data(), digits.data() + digits.size(), value);
  if (status != std::errc() || magnitude.empty() || !(magnitude[0] == '.' || may_follow(magnitude[0])))
    refuse(text, expected);
  std::string_view rest(end, static_cast<std::size_t>(digits.data() + digits.size() - end));
  while (rest.starts_with(' ')) rest.remove_prefix(1);
  return {value, rest};
}

double with_unit(std::string_view text, Units units, const std::string& expected) {
  const auto [value, unit] = leading_number(text, expected);
  for (const auto& [name, factor] : units) {
    // Divided where that is exact in decimal: 250 ms is 250/1000, the double nearest to 0.25.
    if (unit == name) return factor < 1 ? value / std::round(1 / factor) : value * factor;
  }
  refuse(text, expected);
}

}  // namespace

double parse_number(std::string_view text, double lowest, double highest) {
  std::string expected = "a number";
  constexpr double kMost = std::numeric_limits<double>::max();
  if (lowest > -kMost && highest < kMost)
    expected += fmt::format(" from {} to {}", shortest(lowest), shortest(highest));
  else if (lowest > -kMost)
    expected += fmt::format(" not below {}", shortest(lowest));
  else if (highest < kMost)
    expected += fmt::format(" not above {}", shortest(highest));
  const auto [value, rest] = leading_number(text, expected);
  if (!rest.empty() || !(value >= lowest && value <= highest)) refuse(text, expected);
  return value;
}

std::uint64_t parse_count(std::string_view text, std::uint64_t lowest, std::uint64_t highest) {
  std::string expected = "a whole number";
  if (highest != std::numeric_limits<std::uint64_t>::max())
    expected += fmt::format(" from {} to {}", lowest, highest);
  else if (lowest > 0)
    expected += fmt::format(" not below {}", lowest);
  std::uint64_t value = 0;
  const bool octal_looking = text.size() > 1 && text[0] == '0';
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (octal_looking || status != std::errc() || end != text.data() + text.size() || value < lowest || value > highest)
    refuse(text, expected);
  return value;
}

namespace {

double seconds_in(std::string_view text, const std::string& expected) {
  return with_unit(text,
                   {{"", 1},
                    {"s", 1},
                    {"ms", 1e-3},
                    {"us", 1e-6},
                    {"µs", 1e-6},
                    {"ns", 1e-9},
                    {"min", 60},
                    {"h", 3600},
                    {"d", 86400}},
                   expected);
}

}  // namespace

double parse_duration_s(std::string_view text, bool lasts) {
  const std::string expected = fmt::format(
      "a duration such as 90s, 250ms, 5min, 2h or 1d (a bare number is in seconds){}", lasts ? ", above zero" : "");
  const double value = seconds_in(text, expected);
  if (!(value >= 0 && value < 1e12) || (lasts && value == 0)) refuse(text, expected);
  return value;
}

double parse_rate_hz(std::string_view text) {
  const std::string expected =
      "a sampling rate above zero such as 200Hz, 1.5kHz, 1/300 or 60/min, or an interval such as 5min (a bare number "
      "is in "
      "hertz)";
  const auto rate = [&] {
    const std::size_t over = text.find('/');
    if (over != std::string_view::npos && over > 0) {
      std::string_view under = text.substr(over + 1);
      if (under.ends_with("Hz")) under.remove_suffix(2);
      const bool unit = !under.empty() && under[0] >= 'a' && under[0] <= 'z';  // "60/min"
      return with_unit(text.substr(0, over), {{"", 1}}, expected) /
             (unit ? seconds_in("1" + std::string(under), expected) : seconds_in(under, expected));
    }
    const char end = text.empty() ? ' ' : text.back();
    if (end == 's' || end == 'n' || end == 'h' || end == 'd') return 1 / seconds_in(text, expected);
    return with_unit(text, {{"", 1}, {"Hz", 1}, {"hz", 1}, {"mHz", 1e-3}, {"kHz", 1e3}, {"khz", 1e3}, {"MHz", 1e6}},
                     expected);
  };
  const double value = rate();
  if (!(value >= 1e-9 && value <= 1e9)) refuse(text, expected + " between 1 nHz and 1 GHz");
  return value;
}

double parse_rate_hz(std::string_view text, double& uncertainty_hz) {
  uncertainty_hz = 0;
  for (const std::string_view sign : {"±", "+-", "+/-"}) {
    const std::size_t at = text.find(sign);
    if (at == std::string_view::npos || at == 0) continue;
    std::string rate(text.substr(0, at)), off(text.substr(at + sign.size()));
    while (rate.ends_with(' ')) rate.pop_back();
    off.erase(0, std::min(off.find_first_not_of(' '), off.size()));
    const bool per_cent = off.ends_with('%');
    if (per_cent) {
      const double hz = parse_rate_hz(rate);
      uncertainty_hz = hz * parse_number(std::string_view(off).substr(0, off.size() - 1), 0, 100) / 100;
      return hz;
    }
    if (!rate.empty() && may_follow(rate.back()))
      rate += off.substr(off.find_last_of("0123456789.") + 1);  // "200±0.5Hz"
    uncertainty_hz = parse_rate_hz(off);
    return parse_rate_hz(rate);
  }
  return parse_rate_hz(text);
}

namespace {

std::string range_form(RangeOf what) {
  switch (what) {
    case RangeOf::duration_s:
      return "FROM..TO, from a time to a later one (10s..20min; 50.. and ..50 are open at an end)";
    case RangeOf::rate_hz:
      return "LOW..HIGH, from a frequency to a higher one (0.1..20, 50Hz..2kHz; 0.1.. is open above)";
    case RangeOf::number:
      return "LOW..HIGH, from a number to a larger one (0.01..100; 1.. and ..100 are open at an end)";
  }
  return "";
}

Interval range_in(std::string_view text, RangeOf what) {
  const std::string expected = range_form(what);
  const std::size_t dots = text.find("..");
  if (dots == std::string_view::npos) refuse(text, expected);
  const auto end_of = [&](std::string_view end) {
    return what == RangeOf::duration_s ? parse_duration_s(end)
           : what == RangeOf::rate_hz  ? parse_rate_hz(end)
                                       : parse_number(end);
  };
  constexpr double kOpen = std::numeric_limits<double>::infinity();
  const std::string_view from = text.substr(0, dots), to = text.substr(dots + 2);
  const bool open = to.empty() || to == "end";
  if (from.empty() && open) refuse(text, expected);
  const double lowest = what == RangeOf::number ? -kOpen : 0;
  const Interval range{from.empty() ? lowest : end_of(from), open ? kOpen : end_of(to)};
  if (!(range.low < range.high)) refuse(text, expected);
  return range;
}

}  // namespace

Interval parse_range(std::string_view text, RangeOf what, std::string_view where) {
  try {
    return range_in(text, what);
  } catch (const Error& error) {
    Problem problem = error.problem();
    problem.where = where;
    throw Error(problem);
  }
}

std::uint64_t parse_bytes(std::string_view text, std::uint64_t lowest) {
  std::string expected = "a size such as 4096, 64KiB, 500kB, 4MiB or 2GB";
  if (lowest > 0) expected += fmt::format(", not below {} bytes", lowest);
  const double value = with_unit(text,
                                 {{"", 1},
                                  {"B", 1},
                                  {"k", 1024},
                                  {"K", 1024},
                                  {"M", 1048576},
                                  {"G", 1073741824},
                                  {"KiB", 1024},
                                  {"MiB", 1048576},
                                  {"GiB", 1073741824},
                                  {"kB", 1e3},
                                  {"KB", 1e3},
                                  {"MB", 1e6},
                                  {"GB", 1e9}},
                                 expected);
  if (!(value >= static_cast<double>(lowest) && value <= 9007199254740992.0) ||
      value != static_cast<double>(static_cast<std::uint64_t>(value)))
    refuse(text, expected);
  return static_cast<std::uint64_t>(value);
}

}  // namespace libchar
