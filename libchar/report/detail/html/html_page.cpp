#include "libchar/report/detail/html/html_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/core/file/sha256.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
namespace {

int hexadecimal(char c) {
  return c <= '9' ? c - '0' : c - 'a' + 10;
}

// 'sha256-BASE64' of an inline script or style, as a content security policy wants it.
std::string policy_hash(std::string_view content) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  Sha256 sha;
  sha.update(content);
  const std::string hex = sha.finish();
  std::string out = "'sha256-";
  for (std::size_t i = 0; i < 64;
       i += 6) {  // 6 hexadecimal digits are 24 bits; the last group has 16
    std::uint32_t bits = 0;
    const std::size_t digits = std::min<std::size_t>(6, 64 - i);
    for (std::size_t k = 0; k < digits; ++k)
      bits |= static_cast<std::uint32_t>(hexadecimal(hex[i + k])) << (20 - 4 * k);
    for (std::size_t k = 0; k < 4; ++k)
      out += k * 6 < digits * 4 ? kDigits[(bits >> (18 - 6 * k)) & 63U] : '=';
  }
  return out + "'";
}

std::string head(const PageParts& parts, const std::string& script) {
  const std::string policy = fmt::format(
      "default-src 'none'; script-src {} {}; style-src {}; img-src data:; base-uri 'none'; "
      "form-action 'none'",
      policy_hash(chart_js()),
      policy_hash(script),
      policy_hash(parts.style));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta "
      "name=\"referrer\" content=\"no-referrer\">\n"
      "<meta name=\"generator\" content=\"sensorchar {}\">\n<title>{}: "
      "{}</title>\n<style>{}</style>\n"
      "<!--\nThe plots of this page are drawn by Chart.js, (c) Chart.js Contributors, and "
      "@kurkle/color bundled in it, (c) Jukka Kurkela.\nThe licence of both "
      "follows.\n\n{}-->\n</head>\n",
      policy,
      version(),
      html_text(parts.title),
      html_text(parts.subject),
      parts.style,
      html_comment(chart_js_licence()));
}

}  // namespace

std::string command_line(const std::vector<std::string>& command) {
  std::string out;
  for (const std::string& word : command) out += (out.empty() ? "" : " ") + shell_word(word);
  return out;
}

// The line breaks of the document are ours; its strings are not.
std::string settings_details(const Json& document) {
  if (document.is_null() || document.empty()) return "";
  std::string out = "<details><summary>Effective settings</summary>\n<pre>";
  const std::string text = with_valid_text(document).dump(2);
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out += html_text(std::string_view(text).substr(at, end - at)) + "\n";
    at = end + 1;
  }
  return out + "</pre>\n</details>\n";
}

Cell digest_cell(const LogInfo& log) {
  Cell out(log.sha256.empty() ? "not computed" : log.sha256);
  out.code = true;
  return out;
}

void add_input_file(Table& facts, const LogInfo& log) {
  facts.add({"File", log.file});
  facts.add({"Format", log.format});
  facts.add({"Size", count_text(log.bytes) + " bytes, " + count_text(log.rows) + " rows"});
  facts.add({"SHA-256", digest_cell(log)});
}

void add_program(Table& facts, const std::vector<std::string>& command) {
  facts.add({"Tool", "sensorchar " + std::string(version())});
  Cell line(command_line(command));
  line.code = true;
  facts.add({"Command", line});
}

std::string warnings_part(const Findings& warnings) {
  Table out("kind|what|count|first places");
  out.title = "Repairs and warnings";
  for (const Finding& w : warnings.list())
    out.add({w.code,
             w.sentence,
             count_text(w.count),
             fmt::format("{}", fmt::join(w.where.rows, ", "))});
  return out.rows.empty() ? "<h3>" + out.title + "</h3>\n<p>None.</p>\n" : html_table(out);
}

std::string html_page(const PageParts& parts, const std::string& body, const std::string& data) {
  const std::string script = std::string(page_common_js()) + parts.script;
  std::string out = head(parts, script);
  out += "<body>\n<header>\n<h1>" + html_text(parts.title) + " <span class=\"unit\">" +
         html_text(parts.subject) + "</span></h1>\n";
  if (parts.all_numbers)
    out += "<button id=\"download\" type=\"button\" hidden>Download the numbers (JSON)</button>\n";
  out +=
      "</header>\n"
      "<noscript><p class=\"noscript\">The plots need JavaScript. Every number stands in the "
      "tables.</p></noscript>\n<main>\n";
  out += body;
  out += "</main>\n<footer>Written by sensorchar " + std::string(version()) +
         ". Plots: Chart.js, MIT licence (in the source of this page).</footer>\n";
  out += "<script id=\"report-data\" type=\"application/json\">" + data + "</script>\n";
  out += "<script>" + std::string(chart_js()) + "</script>\n<script>" + script +
         "</script>\n</body>\n</html>\n";
  return out;
}

}  // namespace libchar
