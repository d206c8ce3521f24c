#include <nlohmann/json.hpp>

#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
std::string html_text(std::string_view text) { return markup_entities(printable(text)); }

std::string html_prose(std::string_view text) {
  const std::string plain = html_text(text);
  const auto word_end = [&](std::size_t at) { return plain.find_first_not_of("abcdefghijklmnopqrstuvwxyz_", at); };
  std::string out;
  std::size_t done = 0;
  for (std::size_t at = plain.find('`'); at != std::string::npos; at = plain.find('`', at + 1)) {
    const std::size_t end = word_end(at + 1);
    if (end == std::string::npos || end == at + 1 || plain[end] != '`') continue;
    out += plain.substr(done, at - done) + "<code>" + plain.substr(at + 1, end - at - 1) + "</code>";
    done = (at = end) + 1;
  }
  return out + plain.substr(done);
}

std::string html_attribute(std::string_view text) { return markup_entities(printable(text)); }

std::string html_address(std::string_view path) {
  static constexpr std::string_view kPlain = "-._~/";
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string out = "./";
  for (const char c : path) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    const auto byte = static_cast<unsigned char>(c);
    if (letter || kPlain.find(c) != std::string_view::npos)
      out += c;
    else
      out += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return out;
}

std::string json_in_script(const Json& document) {
  // No indent (a line for each number would double the page), and ASCII only: line separators and
  // bidirectional controls inside a script would mislead whoever reads the page's source.
  const std::string plain = with_valid_text(document).dump(-1, ' ', true);
  std::string out;
  out.reserve(plain.size() + plain.size() / 16);
  for (const char c : plain) {
    switch (c) {
      case '<':
        out += "\\u003c";
        break;
      case '>':
        out += "\\u003e";
        break;
      case '&':
        out += "\\u0026";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string html_comment(std::string_view text) {
  std::string out(text);
  for (std::size_t at = 0; (at = out.find("--", at)) != std::string::npos;) out.replace(at, 2, "- -");
  return out;
}

}  // namespace libchar
