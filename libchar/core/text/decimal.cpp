#include "libchar/core/text/decimal.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text/double_text.hpp"

namespace libchar {

std::string shortest(double value) {
  char buffer[40];
  const auto result = detail::write_double(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, result.ptr);
}

std::string shortest_yaml(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value < 0 ? "-.inf" : ".inf";
  std::string text = shortest(value);
  if (text.find('.') != std::string::npos) return text;
  const std::size_t exponent = text.find('e');
  text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
  return text;
}

double rounded(double value, int digits) {
  return parse_double(fmt::format("{:.{}e}", value, digits - 1)).value_or(value);
}

std::optional<double> parse_double(std::string_view text) {
  double value = 0;
  const auto [end, status] = detail::read_double(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace libchar
