// Any text as numbers, by every parser of numbers: cells and stamps of a CSV file, one at a time
// and whole rows by vector instructions, and numbers as one types them. The judges are strtod and
// 128-bit integers, behind a grammar that is written out here.

#include <cmath>
#include <optional>
#include <vector>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/log/csv/rows/number.hpp"
#include "libchar/log/csv/rows/vector_rows.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

struct Decimal {
  std::string digits;      // before and behind the mark
  std::size_t behind = 0;  // of them behind it
  bool negative = false, mark = false, exponent = false;
};

std::size_t digits_at(std::string_view text, std::size_t& i, std::string& digits) {
  const std::size_t first = i;
  while (i < text.size() && text[i] >= '0' && text[i] <= '9') digits += text[i++];
  return i - first;
}

/// [+-] digits [mark digits] [e [+-] digits], at least one digit before the exponent; the whole text.
std::optional<Decimal> decimal(std::string_view text, char mark) {
  Decimal d;
  std::size_t i = 0;
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) d.negative = text[i++] == '-';
  digits_at(text, i, d.digits);
  if (i < text.size() && text[i] == mark) {
    d.mark = true;
    d.behind = digits_at(text, ++i, d.digits);
  }
  if (d.digits.empty()) return std::nullopt;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    d.exponent = true;
    ++i;
    if (i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
    std::string exponent;
    if (digits_at(text, i, exponent) == 0) return std::nullopt;
  }
  return i == text.size() ? std::optional(d) : std::nullopt;
}

double judged(std::string_view text, char mark) {
  std::string plain(text);
  for (char& c : plain)
    if (c == mark) c = '.';
  return std::strtod(plain.c_str(), nullptr);
}

/// The stamp in ns by 128-bit integers, for up to 24 digits without an exponent.
std::optional<csv::Int128> judged_stamp(const Decimal& d, std::int64_t unit_ns) {
  if (d.exponent || d.digits.size() > 24) return std::nullopt;
  csv::Int128 number = 0, scale = 1;
  for (const char c : d.digits) number = number * 10 + (c - '0');
  for (std::size_t i = 0; i < d.behind; ++i) scale *= 10;
  number *= unit_ns;
  csv::Int128 whole = number / scale;
  const csv::Int128 rest = number % scale;
  if (2 * rest > scale || (2 * rest == scale && whole % 2 == 1)) ++whole;
  return d.negative ? -whole : whole;
}

void check_cell(const std::string& text, char mark) {
  const csv::Cell cell = csv::read_cell(text, mark);
  const auto number = decimal(text, mark);
  if (!number) {
    fuzz::expect(cell.kind != csv::Cell::value && cell.kind != csv::Cell::out_of_range, "a number that is none");
    return;
  }
  const double value = judged(text, mark);
  fuzz::expect(cell.kind == (std::isfinite(value) ? csv::Cell::value : csv::Cell::out_of_range),
               "a number that is not taken");
  if (cell.kind != csv::Cell::value) return;
  fuzz::expect_same(text.c_str(), fuzz::bits(cell.number), fuzz::bits(value));
  fuzz::expect(cell.integer == (!number->mark && !number->exponent), "an integer or not");
}

void check_quick_number(const std::string& text, char mark) {
  const std::string padded = text + ";" + std::string(64, '7');
  double value = 0;
  bool integer = false;
  const char* const end = csv::quick_number(padded.data(), mark, value, integer);
  if (end == nullptr) return;
  const std::string taken(padded.data(), end);
  const auto number = decimal(taken, mark);
  fuzz::expect(number.has_value(), "a quick number that is none");
  fuzz::expect_same(taken.c_str(), fuzz::bits(value), fuzz::bits(judged(taken, mark)));
  fuzz::expect(integer == (!number->mark && !number->exponent), "a quick integer or not");
}

void check_stamp(const std::string& text, char mark, int unit_digits) {
  const std::int64_t unit = csv::kNanoseconds[static_cast<std::size_t>(unit_digits)];
  std::int64_t ns = 0, quick_ns = 0;
  std::size_t offset = 0;
  const csv::StampDefect fault = csv::read_stamp(text, mark, unit, ns, offset);
  fuzz::expect(offset <= text.size(), "a place beyond the text");
  if (const auto number = decimal(text, mark)) {
    fuzz::expect(fault == csv::StampDefect::none || fault == csv::StampDefect::out_of_range,
                 "a stamp that is not taken");
    if (const auto judge = judged_stamp(*number, unit)) {
      const bool fits = *judge >= INT64_MIN && *judge <= INT64_MAX;
      fuzz::expect((fault == csv::StampDefect::none) == fits, "a stamp in range or not");
      if (fits) fuzz::expect(ns == static_cast<std::int64_t>(*judge), "another stamp");
    }
  } else {
    fuzz::expect(fault != csv::StampDefect::none, "a stamp that is none");
  }
  const std::string padded = text + ";" + std::string(64, '9');
  const char* const end = csv::quick_stamp(padded.data(), mark, unit_digits, quick_ns);
  if (end != nullptr && end == padded.data() + text.size())
    fuzz::expect(fault == csv::StampDefect::none && quick_ns == ns, "another quick stamp");
}

/// Rows of a stamp and two values, by vector instructions: what is taken must be what the judges say.
void check_rows(std::string text, int unit_digits, bool crlf) {
  constexpr std::size_t kRows = 64;
  const std::size_t size = text.size();
  text.append(kVectorPadding, '\0');
  std::vector<double> a(kRows + 8), b(kRows + 8);
  std::vector<std::int64_t> stamps(kRows + 8);
  char fractional_a = 0, fractional_b = 0;
  using Use = VectorColumn::Use;
  const VectorColumn columns[] = {{.use = Use::stamp, .stamps = stamps.data(), .stamp_digits = unit_digits},
                                  {.use = Use::value, .values = a.data(), .fractional = &fractional_a},
                                  {.use = Use::value, .values = b.data(), .fractional = &fractional_b}};
  std::vector<std::uint32_t> scratch;
  const VectorRows result = parse_vector_rows({text.data(), size}, ',', crlf, columns, kRows, scratch);
  fuzz::expect(result.rows <= kRows && result.consumed <= size, "more rows than there are");
  std::size_t at = 0;
  for (std::size_t row = 0; row < result.rows; ++row) {
    const auto field = [&](const char* stop) {
      const std::size_t end = text.find(stop, at);
      fuzz::expect(end < size, "a row without its end");
      std::string one = text.substr(at, end - at);
      at = end + std::strlen(stop);
      return one;
    };
    const std::string stamp = field(","), first = field(","), second = field(crlf ? "\r\n" : "\n");
    const auto number = decimal(stamp, '.');
    fuzz::expect(number && decimal(first, '.') && decimal(second, '.'), "a row of no numbers");
    if (const auto judge = judged_stamp(*number, csv::kNanoseconds[static_cast<std::size_t>(unit_digits)]))
      fuzz::expect(*judge == stamps[row], "another stamp of a row");
    fuzz::expect_same(first.c_str(), fuzz::bits(a[row]), fuzz::bits(judged(first, '.')));
    fuzz::expect_same(second.c_str(), fuzz::bits(b[row]), fuzz::bits(judged(second, '.')));
  }
  fuzz::expect(at == result.consumed, "bytes that no row took");
}

void check_typed(std::string_view text) {
  const auto number = parse_double(text);
  const auto plain = decimal(text, '.');
  const bool taken = plain && text[0] != '+' && std::isfinite(judged(text, '.'));
  if (number) {
    fuzz::expect(taken, "a double that is none");
    fuzz::expect_same("a double", fuzz::bits(*number), fuzz::bits(judged(text, '.')));
  }
  const auto attempt = [&](auto&& parse) {
    try {
      fuzz::expect(std::isfinite(static_cast<double>(parse(text))), "no number was accepted");
    } catch (const Error& error) {
      fuzz::said(error);
    }
  };
  attempt([](std::string_view t) { return parse_number(t); });
  attempt([](std::string_view t) { return parse_count(t); });
  attempt([](std::string_view t) { return parse_duration_s(t); });
  attempt([](std::string_view t) { return parse_rate_hz(t); });
  attempt([](std::string_view t) { return parse_bytes(t); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const unsigned choice = data[0];
  const char mark = (choice & 1U) != 0 ? ',' : '.';
  const int unit_digits = static_cast<int>(choice >> 1U) % 4 * 3;
  const std::string text(reinterpret_cast<const char*>(data + 1), size - 1);
  check_rows(text, unit_digits, (choice & 8U) != 0);
  // A cell ends where the reader says; a NUL never stands in one.
  const std::string cell = text.substr(0, text.find('\0'));
  check_cell(cell, mark);
  check_quick_number(cell, mark);
  check_stamp(cell, mark, unit_digits);
  check_typed(cell);
  return 0;
}
