#include "libchar/core/text/markup.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {

std::string markup_entities(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string markdown_text(std::string_view text) {
  std::string out;
  for (const char c : printable(text)) {
    if (std::string_view("\\`*_{}[]<>|#~&").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

namespace {

// A terminal obeys them; a line break is quoted.
std::string without_control_bytes(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool obeyed = (byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte == 0x7f;
    out += obeyed ? fmt::format("\\x{:02X}", byte) : std::string(1, c);
  }
  return out;
}

}  // namespace

// Spreadsheets take the full-width signs (U+FF1D, FF0B, FF0D, FF20) for the ASCII ones.
bool begins_like_a_formula(std::string_view text) {
  for (const std::string_view wide : {"\xEF\xBC\x9D", "\xEF\xBC\x8B", "\xEF\xBC\x8D", "\xEF\xBC\xA0"})
    if (text.starts_with(wide)) return true;
  return !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos;
}

std::string csv_cell(std::string_view text) {
  std::string cell = without_control_bytes(text);
  if (begins_like_a_formula(text)) cell.insert(0, "'");
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string csv_cell(double value) { return std::isfinite(value) ? shortest(value) : ""; }

std::string csv_cell(const std::optional<double>& value) { return value ? csv_cell(*value) : ""; }

}  // namespace libchar
