#include "libchar/core/text/double_text.hpp"

#if !defined(__cpp_lib_to_chars) || defined(LIBCHAR_SERIAL)

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

namespace libchar::detail {
namespace {

/// Do the digits in front of the exponent say anything but zero?
bool says_nonzero(std::string_view number) {
  return number.substr(0, number.find_first_of("eE")).find_first_of("123456789") != std::string_view::npos;
}

bool spells_infinity(std::string_view number) { return number.find_first_of("iI") != std::string_view::npos; }

/// 0.digits * 10^exponent
struct Decimal {
  std::string digits;
  int exponent = 0;
};

// fmt's text has the shortest digits, and a notation of its own.
Decimal shortest_decimal(double value) {
  const std::string text = fmt::format("{}", value);
  Decimal out;
  const std::size_t e = std::min(text.find('e'), text.size());
  if (e < text.size())  // from_chars takes no '+'
    std::from_chars(text.data() + e + (text[e + 1] == '+' ? 2 : 1), text.data() + text.size(), out.exponent);
  const std::size_t point = std::min(text.find('.'), e);
  out.exponent += static_cast<int>(point);
  for (const char c : std::string_view(text).substr(0, e))
    if (c != '.') out.digits += c;
  const std::size_t zeros = std::min(out.digits.find_first_not_of('0'), out.digits.size() - 1);
  out.digits.erase(0, zeros);
  out.exponent -= static_cast<int>(zeros);
  while (out.digits.size() > 1 && out.digits.back() == '0') out.digits.pop_back();
  return out;
}

std::string scientific(const Decimal& number) {
  std::string out = number.digits.substr(0, 1);
  if (number.digits.size() > 1) out += "." + number.digits.substr(1);
  const int exponent = number.exponent - 1;
  return out + fmt::format("e{}{:02}", exponent < 0 ? '-' : '+', std::abs(exponent));
}

std::string fixed(const Decimal& number, double value) {
  const auto count = static_cast<int>(number.digits.size());
  if (number.exponent <= 0) return "0." + std::string(static_cast<std::size_t>(-number.exponent), '0') + number.digits;
  const auto whole = static_cast<std::size_t>(number.exponent);
  if (number.exponent < count) return number.digits.substr(0, whole) + "." + number.digits.substr(whole);
  // All digits of a whole number, as printf has them: beyond 2^53 more than the shortest.
  return fmt::format("{:.0f}", value);
}

std::string shortest_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return "inf";
  if (value == 0) return "0";
  const Decimal number = shortest_decimal(value);
  const std::string exponential = scientific(number), plain = fixed(number, value);
  return plain.size() <= exponential.size() ? plain : exponential;
}

}  // namespace

std::from_chars_result read_double(const char* first, const char* last, double& value) {
  double read = 0;
  const auto [end, status] = fast_float::from_chars(first, last, read);
  if (status != std::errc()) return {end, status};
  const std::string_view number(first, static_cast<std::size_t>(end - first));
  if ((std::isinf(read) && !spells_infinity(number)) || (read == 0 && says_nonzero(number)))
    return {end, std::errc::result_out_of_range};
  value = read;
  return {end, status};
}

std::to_chars_result write_double(char* first, char* last, double value) {
  const std::string text = (std::signbit(value) ? "-" : "") + shortest_text(std::fabs(value));
  if (static_cast<std::size_t>(last - first) < text.size()) return {last, std::errc::value_too_large};
  return {std::copy(text.begin(), text.end(), first), std::errc()};
}

}  // namespace libchar::detail

#endif
