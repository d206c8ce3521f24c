#include "libchar/log/csv/rows/number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "libchar/core/text/double_text.hpp"

namespace libchar::csv {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_word(std::string_view text, std::string_view word) {
  if (text.size() != word.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (lower(text[i]) != word[i]) return false;
  return true;
}

/// Displays fill a field with one sign where they have no value: ---, ****, ??.
bool is_filling(std::string_view text) {
  const char sign = text[0];
  return (sign == '-' || sign == '*' || sign == '?') && text.find_first_not_of(sign) == std::string_view::npos;
}

// Behind them the errors of spreadsheets, and what multimeters show beyond their range.
bool means_missing(std::string_view text) {
  if (text.empty() || is_filling(text)) return true;
  if (is_digit(text.back())) return false;
  for (const char* word : {"nan",       "na",
                           "n/a",       "n.a.",
                           "<na>",      "null",
                           "none",      "nil",
                           "-nan",      "+nan",
                           "-nan(ind)", "nan(ind)",
                           "#n/a",      "#na",
                           "#num!",     "#value!",
                           "#div/0!",   "#ref!",
                           "#null!",    "#name?",
                           "[n/a]",     "[not supported]",  // nvidia-smi
                           "ol",        "-ol",
                           "+ol",       "o.l",
                           "-o.l",      "o.l.",
                           "ovld",      "-ovld",
                           "overload"})
    if (is_word(text, word)) return true;
  return false;
}

bool means_infinite(std::string_view text) {
  if (is_digit(text.back())) return false;
  if (text[0] == '+' || text[0] == '-') text.remove_prefix(1);
  return is_word(text, "inf") || is_word(text, "infinity") || text == "\xE2\x88\x9E";  // ∞ of Torque
}

// Why `text` is not a number and where, for the message: the first byte that cannot continue a
// number, or the start of the cell when the number stops too early or its signs are wrong.
Cell explain(std::string_view text, char point) {
  Cell cell;
  std::size_t i = 0;
  if (text[i] == '+' || text[i] == '-') ++i;
  if (i < text.size() && i > 0 && (text[i] == '+' || text[i] == '-')) {
    cell.reason = "two signs before a number";
    return cell;
  }
  const std::size_t start = i;
  std::size_t digits = 0;
  bool mark = false;
  for (; i < text.size() && (is_digit(text[i]) || (text[i] == point && !mark)); ++i) {
    digits += is_digit(text[i]);
    mark = mark || text[i] == point;
  }
  if (digits > 0 && i < text.size() && lower(text[i]) == 'e') {
    std::size_t e = i + 1;
    if (e < text.size() && (text[e] == '+' || text[e] == '-')) ++e;
    const std::size_t first = e;
    while (e < text.size() && is_digit(text[e])) ++e;
    if (e == text.size() && e == first) {
      cell.reason = "a number cut off in its exponent";
      return cell;
    }
    i = e;
  }
  if (i == text.size()) {
    cell.reason = "a number without digits";
    return cell;
  }
  cell.offset = i == start ? 0 : i;
  const std::string_view rest = text.substr(cell.offset);
  const auto begins = [&](std::string_view what) { return rest.substr(0, what.size()) == what; };
  if (rest[0] == '\0')
    cell.reason = "a NUL byte, a number was expected";
  else if (rest[0] == '\x1A')
    cell.reason = "a Ctrl-Z byte (0x1A, the end-of-file mark of old systems), a number was expected";
  else if (begins("\xE2\x88\x92"))
    cell.reason = "a minus sign of typesetting (U+2212) where '-' was expected";
  else if (begins("\xC2\xA0"))
    cell.reason = "a no-break space (U+00A0) in a number";
  else if (begins("\xE2\x80\x8B"))
    cell.reason = "an invisible zero-width space (U+200B) before a number";
  else if (lower(rest[0]) == 'x' && text.substr(start, i - start) == "0")
    cell.reason = "a hexadecimal number, where decimal ones are read";
  else if (digits > 0 && rest[0] == '_')
    cell.reason = "an underscore in a number";
  else if (digits > 0 && (rest[0] == ',' || rest[0] == '.'))
    cell.reason = "a second decimal mark or a thousands separator in a number";
  else if (digits > 0)
    cell.reason = "a number was expected to end here";
  else
    cell.reason = "a number was expected";
  return cell;
}

// Is |number| < 1? Decides between overflow and underflow; the text is a well-formed number other than zero.
bool below_one(std::string_view text) {
  const std::size_t e = text.find_first_of("eE");
  const std::string_view digits = text.substr(0, e);
  const std::size_t first = digits.find_first_of("123456789");
  const std::size_t point = std::min(digits.find('.'), digits.size());
  if (first == std::string_view::npos) return true;
  // Decimal exponent of the first digit that counts.
  const double position =
      first < point ? static_cast<double>(point - first) - 1 : static_cast<double>(point) - static_cast<double>(first);
  double exponent = 0;
  if (e != std::string_view::npos) {
    const bool down = e + 1 < text.size() && text[e + 1] == '-';
    for (std::size_t i = e + 1; i < text.size(); ++i)
      if (is_digit(text[i])) exponent = std::min(1e18, exponent * 10 + (text[i] - '0'));
    if (down) exponent = -exponent;
  }
  return position + exponent < 0;
}

// A decimal number as it is written: w · 10^q.
struct Written {
  Uint128 w = 0;
  int q = 0;
  bool any = false;   // a digit was there
  bool lost = false;  // digits other than 0 behind those of w
  std::size_t end = 0;
};

// The digits from i on, with at most one mark among them.
Written read_mantissa(std::string_view text, std::size_t i, char point) {
  Written out;
  bool fraction = false;
  for (; i < text.size(); ++i) {
    if (text[i] == point && !fraction) {
      fraction = true;
    } else if (is_digit(text[i])) {
      out.any = true;
      // 25 digits leave room for the largest unit, an hour; further digits stand far below a
      // nanosecond or far above 64 bits.
      if (out.w < static_cast<Uint128>(1000000000000) * 1000000000000) {
        out.w = out.w * 10 + static_cast<unsigned>(text[i] - '0');
        out.q -= fraction;
      } else {
        out.q += !fraction;
        out.lost = out.lost || text[i] != '0';
      }
    } else {
      break;
    }
  }
  out.end = i;
  return out;
}

// Adds an exponent at number.end to it; numbers beyond 10^±10000 are out of range.
StampDefect read_exponent(std::string_view text, Written& number) {
  const std::size_t i = number.end;
  if (!number.any || i == text.size() || lower(text[i]) != 'e') return StampDefect::none;
  int exponent = 0;
  const char* from = text.data() + i + 1;
  const char* const end = text.data() + text.size();
  // from_chars takes a '-' itself, and must not see one behind the '+'.
  if (end - from > 1 && *from == '+' && is_digit(from[1])) ++from;
  const auto [stop, status] = std::from_chars(from, end, exponent);
  if (stop == from) return StampDefect::malformed;
  number.end = static_cast<std::size_t>(stop - text.data());
  if (status != std::errc() || exponent > 10000 || exponent < -10000) return StampDefect::out_of_range;
  number.q += exponent;
  return StampDefect::none;
}

// w / 10^-q for q < 0, the half rounded to even.
Uint128 rounded_quotient(Uint128 w, int q, bool lost) {
  Uint128 divisor = 1;
  bool sticky = lost;
  for (; q < -30; ++q) {
    sticky = sticky || w % 10 != 0;
    w /= 10;
  }
  for (; q < 0; ++q) divisor *= 10;
  const Uint128 quotient = w / divisor, twice = (w % divisor) * 2;
  const bool up = twice > divisor || (twice == divisor && (sticky || (quotient & 1U) != 0));
  return quotient + (up ? 1U : 0U);
}

}  // namespace

Cell read_cell(std::string_view text, char point) {
  Cell cell;
  if (means_missing(text)) {
    cell.kind = Cell::missing;
    return cell;
  }
  if (means_infinite(text)) {
    cell.kind = Cell::infinite;
    return cell;
  }
  std::string with_point;
  std::string_view digits = text;
  if (point != '.') {
    if (text.find('.') != std::string_view::npos) {
      cell.offset = text.find('.');
      cell.reason = "a decimal point where decimal commas were expected";
      return cell;
    }
    with_point = std::string(text);
    if (const std::size_t comma = with_point.find(point); comma != std::string::npos) with_point[comma] = '.';
    digits = with_point;
  }
  if (digits.size() > 1 && digits[0] == '+' && (is_digit(digits[1]) || digits[1] == '.')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, status] = detail::read_double(digits.data(), digits.data() + digits.size(), value);
  const bool whole = end == digits.data() + digits.size();
  if (whole && status == std::errc::result_out_of_range) {
    if (!below_one(digits)) {
      cell.kind = Cell::out_of_range;
      cell.reason = "number out of range";
      return cell;
    }
    cell.kind = Cell::value;  // nearer to zero than to the least double: zero is the correct rounding
    cell.number = digits[0] == '-' ? -0.0 : 0.0;
    // 700 zeros written out are somebody's way of rounding; an exponent that no double has is lost digits.
    const std::size_t exponent = digits.find_first_of("eE");
    cell.too_small = exponent != std::string_view::npos &&
                     digits.substr(0, exponent).find_first_of("123456789") != std::string_view::npos;
    return cell;
  }
  if (!whole || status != std::errc() || !std::isfinite(value)) return explain(text, point);
  cell.kind = Cell::value;
  cell.number = value;
  cell.integer = std::all_of(digits.begin(), digits.end(), [](char c) { return is_digit(c) || c == '-'; });
  if (cell.integer && std::fabs(value) >= 9007199254740992.0) {  // 2^53: does the integer survive?
    Int128 exact = 0;
    for (const char c : digits)
      if (is_digit(c) && exact < (static_cast<Int128>(1) << 100U)) exact = exact * 10 + (c - '0');
    cell.inexact_integer = std::fabs(value) < 1e30 && static_cast<Int128>(std::fabs(value)) != exact;
  }
  return cell;
}

StampDefect read_stamp(std::string_view text, char point, std::int64_t unit_ns, std::int64_t& out, std::size_t& offset,
                       double zero) {
  offset = 0;
  if (means_missing(text)) return StampDefect::missing;
  const bool negative = text[0] == '-';
  Written number = read_mantissa(text, negative || text[0] == '+' ? 1 : 0, point);
  const StampDefect fault = read_exponent(text, number);
  if (fault == StampDefect::malformed) return fault;
  if (!number.any || number.end < text.size()) {
    offset = number.any ? number.end : 0;
    return StampDefect::malformed;
  }
  if (fault == StampDefect::out_of_range) {
    if (number.w != 0) return fault;
    out = 0;
    return StampDefect::none;
  }
  Uint128 ns = number.w * static_cast<std::uint64_t>(unit_ns);
  const Uint128 limit = static_cast<Uint128>(1) << 63U;
  for (int q = number.q; q > 0 && ns != 0; --q) {
    if (ns > limit) return StampDefect::out_of_range;
    ns *= 10;
  }
  if (number.q < 0) ns = rounded_quotient(ns, number.q, number.lost);
  if (zero > 0 && !negative && ns < limit * limit / 4) {
    const auto from = static_cast<Int128>(ns) - static_cast<Int128>(zero * static_cast<double>(unit_ns));
    if (from > INT64_MAX || from < INT64_MIN) return StampDefect::out_of_range;
    out = static_cast<std::int64_t>(from);
    return StampDefect::none;
  }
  if (ns > limit - (negative ? 0U : 1U)) return StampDefect::out_of_range;
  out = negative ? static_cast<std::int64_t>(-static_cast<Int128>(ns)) : static_cast<std::int64_t>(ns);
  return StampDefect::none;
}

}  // namespace libchar::csv
