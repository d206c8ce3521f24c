#include "libchar/core/text/csv_cell.hpp"

#include <cmath>

#include "libchar/core/text/decimal.hpp"

namespace libchar {

bool begins_like_a_formula(std::string_view text) {
  return !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos;
}

std::string csv_cell(std::string_view text) {
  std::string cell(text);
  if (begins_like_a_formula(text)) cell.insert(0, "'");
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string csv_cell(double value) {
  return std::isfinite(value) ? shortest(value) : "";
}

std::string csv_cell(const std::optional<double>& value) {
  return value ? csv_cell(*value) : "";
}

}  // namespace libchar
