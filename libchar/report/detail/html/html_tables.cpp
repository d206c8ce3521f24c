#include "libchar/report/detail/html/html_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "libchar/core/file/sha256.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/assets.hpp"

namespace libchar {
namespace {

bool is_small(char c) { return c >= 'a' && c <= 'z'; }

/// "term" as "Term"; symbols ("p") stay as they are.
std::string capital(const Table::Column& column) {
  std::string head = column.head;
  if (!column.name && head.size() > 1 && is_small(head[0]) && (is_small(head[1]) || head[1] == ' '))
    head[0] = static_cast<char>(head[0] - 'a' + 'A');
  return head;
}

/// With a true minus in front of its numbers: "−37.2 %".
std::string number_html(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins = i == 0 || text[i - 1] == ' ' || text[i - 1] == '[';
    const bool number = i + 1 < text.size() && text[i + 1] >= '0' && text[i + 1] <= '9';
    if (text[i] == '-' && begins && number)
      out += "−";
    else
      out += text[i];
  }
  return html_prose(out);
}

std::string linked(const Cell& cell) {
  if (cell.code) return html_text(cell.text);
  const std::string text = number_html(cell.text);
  if (!cell.anchor.empty()) return fmt::format("<a href=\"#{}\">{}</a>", html_attribute(cell.anchor), text);
  if (!cell.address.empty()) return fmt::format("<a href=\"{}\">{}</a>", html_address(cell.address), text);
  return text;
}

std::string cell_content(const Cell& cell) {
  std::string out = cell.tint && !cell.is_number ? html_chip(cell.text, cell.tint) : linked(cell);
  if (!cell.unit.empty()) out += " <span class=\"dim\">" + html_text(cell.unit) + "</span>";
  for (const Cell::Mark& mark : cell.marks) out += " " + html_chip(mark.text, mark.tint);
  const std::string interval = cell.high.empty() ? cell.low : fmt::format("[{}, {}]", cell.low, cell.high);
  if (!interval.empty()) out += "<span class=\"ci\">" + number_html(interval) + "</span>";
  for (const std::string& note : cell.notes) out += "<span class=\"ci dim\">" + html_prose(note) + "</span>";
  for (const Cell& line : cell.lines) out += "<div>" + cell_content(line) + "</div>";
  return out;
}

std::string html_cell(const Cell& cell, const Table::Column& column, std::size_t span, PageTable look) {
  std::vector<const char*> css;
  if (cell.is_number) css.push_back("n");
  if (column.folded) css.push_back("more");
  if (cell.is_number && cell.tint == Tint::absent) css.push_back("limit");
  if (cell.code) css.push_back("hash");
  std::string out = "<td";
  if (!css.empty()) out += fmt::format(" class=\"{}\"", fmt::join(css, " "));
  if (span > 1) out += fmt::format(" colspan=\"{}\"", span);
  if (look.sorted) out += fmt::format(" data-value=\"{}\"", csv_cell(cell.value));
  if (look.cards && span == 1) out += " data-label=\"" + html_attribute(capital(column)) + "\"";
  return out + ">" + cell_content(cell) + "</td>";
}

/// The columns that the page shows.
using Shown = std::vector<std::size_t>;

std::string html_row(const Table& table, const Shown& shown, std::size_t r, PageTable look) {
  const Table::Row& row = table.rows[r];
  if (row.kind == Table::Kind::part)
    return fmt::format("</tbody>\n<tbody class=\"bounds\">\n<tr><th colspan=\"{}\">{}</th></tr>\n", shown.size(),
                       html_text(row.cells[0].text));
  constexpr const char* kKinds[] = {"<tr>", "<tr class=\"best\">", "<tr class=\"bound\">", "<tr class=\"derived\">"};
  std::string out = kKinds[static_cast<std::size_t>(row.kind)];
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Cell& cell = table.cell(r, shown[i]);
    const bool wide = row.kind == Table::Kind::derived && shown[i] + 1 == row.cells.size();
    const std::size_t span = wide ? shown.size() - i : 1;
    PageTable here = look;
    here.sorted = look.sorted && table.holds_numbers(shown[i]);
    out += i == 0 ? "<th scope=\"row\">" + cell_content(cell) + "</th>"
                  : html_cell(cell, table.columns[shown[i]], span, here);
    i += span - 1;
  }
  return out + "</tr>\n";
}

std::string html_head(const Table& table, const Shown& shown) {
  std::string out = "<thead><tr>";
  bool any = false;
  for (const std::size_t c : shown) {
    const Table::Column& column = table.columns[c];
    any = any || !column.head.empty();
    out += fmt::format("<th scope=\"col\"{}{}>{}</th>", column.folded ? " class=\"more\"" : "",
                       column.about.empty() ? "" : " title=\"" + html_attribute(column.about) + "\"",
                       html_text(capital(column)));
  }
  return any ? out + "</tr></thead>\n" : "";
}

}  // namespace

std::string detail::missing_text(const MissingSamples& missing, std::string_view open, std::string_view close) {
  const auto counted = [&](std::uint64_t n, const char* one, const char* many) {
    return fmt::format("{}{}{} {}", open, count_text(n), close, n == 1 ? one : many);
  };
  if (missing.gaps > 0)
    return fmt::format("{}, {} missing", counted(missing.gaps, "gap", "gaps"),
                       counted(missing.in_gaps, "sample", "samples"));
  if (missing.of_a_channel == 0) return "no gaps";
  return fmt::format("no gaps in time, up to {} of a channel missing",
                     counted(missing.of_a_channel, "sample", "samples"));
}

std::string html_table(const Table& table, const PageTable& look) {
  Shown shown;
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if ((table.columns[c].doors & Table::kPage) != 0 && table.says_anything(c)) shown.push_back(c);
  const std::size_t count = std::max(look.of, table.rows.size());
  const std::size_t rows = std::min(look.most > 0 ? look.most : count, table.rows.size());
  std::string out = table.title.empty() ? "" : "<h3>" + html_text(table.title) + "</h3>\n";
  out += "<div class=\"wide\"><table" + (*look.css == 0 ? "" : fmt::format(" class=\"{}\"", look.css)) + ">\n" +
         html_head(table, shown) + "<tbody>\n";
  for (std::size_t r = 0; r < rows; ++r) out += html_row(table, shown, r, look);
  out += "</tbody></table></div>\n";
  if (rows < count)
    out +=
        fmt::format("<p class=\"note\">The first {} of {}; all are in {}.</p>\n", rows, count_text(count), look.rest);
  return table.note.empty() ? out : out + "<p class=\"note\">" + html_prose(table.note) + "</p>\n";
}

std::string folded(const std::string& summary, const std::string& body, bool open) {
  return fmt::format("<details{}><summary>{}</summary>\n{}</details>\n", open ? " open" : "", summary, body);
}

std::string html_chip(std::string_view word, std::optional<Tint> tint) {
  constexpr const char* kTints[] = {" detected", " unsure", " alarm", " absent"};
  return fmt::format("<span class=\"chip{}\">{}</span>", tint ? kTints[static_cast<std::size_t>(*tint)] : "",
                     html_text(word));
}

std::string_view rating_sign(Rating rating) {
  return rating == Rating::good ? "✓" : rating == Rating::caution ? "!" : "✗";
}

std::string rating_badge(Rating rating) {
  return fmt::format("<span class=\"badge {}\">{} {}</span>", name_of(rating), rating_sign(rating),
                     rating_word(rating));
}

namespace {

std::string finding_item(const Finding& one) {
  std::string out =
      fmt::format("<li class=\"{}\" title=\"{}\">", name_of(one.severity), one.code) + html_prose(one.sentence);
  for (const Finding::Help& help : one.help) out += " <span class=\"help\">" + html_text(help.sentence) + "</span>";
  return out + "</li>\n";
}

}  // namespace

std::string findings_list(const std::vector<Finding>& findings) {
  constexpr std::size_t kShown = 5;
  std::string shown, rest;
  for (std::size_t i = 0; i < findings.size(); ++i) (i < kShown ? shown : rest) += finding_item(findings[i]);
  if (shown.empty()) return "";
  const auto list = [](const std::string& items) { return "<ul class=\"findings\">\n" + items + "</ul>\n"; };
  return list(shown) + (rest.empty() ? "" : folded(fmt::format("{} more", findings.size() - kShown), list(rest)));
}

std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class) {
  if (items.empty()) return "";
  std::string out = fmt::format("<ul class=\"{}\">\n", css_class);
  for (const std::string& item : items) out += "<li>" + html_prose(item) + "</li>\n";
  return out + "</ul>\n";
}

namespace {

int hexadecimal(char c) { return c <= '9' ? c - '0' : c - 'a' + 10; }

// 'sha256-BASE64' of an inline script or style, as a content security policy wants it.
std::string policy_hash(std::string_view content) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  Sha256 sha;
  sha.update(content);
  const std::string hex = sha.finish();
  std::string out = "'sha256-";
  for (std::size_t i = 0; i < 64; i += 6) {  // 6 hexadecimal digits are 24 bits; the last group has 16
    std::uint32_t bits = 0;
    const std::size_t digits = std::min<std::size_t>(6, 64 - i);
    for (std::size_t k = 0; k < digits; ++k)
      bits |= static_cast<std::uint32_t>(hexadecimal(hex[i + k])) << (20 - 4 * k);
    for (std::size_t k = 0; k < 4; ++k) out += k * 6 < digits * 4 ? kDigits[(bits >> (18 - 6 * k)) & 63U] : '=';
  }
  return out + "'";
}

std::string head(const PageParts& parts, const std::string& script) {
  const std::string policy = fmt::format(
      "default-src 'none'; script-src {} {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'",
      policy_hash(chart_js()), policy_hash(script), policy_hash(parts.style));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"referrer\" "
      "content=\"no-referrer\">\n"
      "<meta name=\"generator\" content=\"sensorchar {}\">\n<title>{}: {}</title>\n<style>{}</style>\n"
      "<!--\nThe plots of this page are drawn by Chart.js, (c) Chart.js Contributors, and @kurkle/color bundled in it, "
      "(c) Jukka Kurkela.\nThe licence of both follows.\n\n{}-->\n</head>\n",
      policy, version(), html_text(parts.title), html_text(parts.subject), parts.style,
      html_comment(chart_js_licence()));
}

}  // namespace

std::string command_line(const std::vector<std::string>& command) {
  std::string out;
  for (const std::string& word : command) out += (out.empty() ? "" : " ") + shell_word(word);
  return out;
}

// The line breaks of the document are ours; its strings are not.
std::string next_part(const std::vector<std::string>& commands) {
  std::string out;
  for (const std::string& command : commands) out += html_text(command) + "\n";
  return out.empty() ? "" : "<div class=\"next\">\n<h3>What next</h3>\n<pre>" + out + "</pre>\n</div>\n";
}

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
    out.add({w.code, w.sentence, count_text(w.count), fmt::format("{}", fmt::join(w.where.rows, ", "))});
  return out.rows.empty() ? "<h3>" + out.title + "</h3>\n<p>None.</p>\n" : html_table(out);
}

std::string html_page(const PageParts& parts, const std::string& body, const std::string& data) {
  const std::string script = std::string(page_common_js()) + parts.script;
  std::string out = head(parts, script);
  out += "<body>\n<header>\n<h1>" + html_text(parts.title) + " <span class=\"unit\">" + html_text(parts.subject) +
         "</span></h1>\n";
  if (parts.all_numbers) out += "<button id=\"download\" type=\"button\" hidden>Download the numbers (JSON)</button>\n";
  out +=
      "</header>\n"
      "<noscript><p class=\"noscript\">The plots need JavaScript. Every number is in the "
      "tables.</p></noscript>\n<main>\n";
  out += body;
  out += "</main>\n<footer>Written by sensorchar " + std::string(version()) +
         ". Plots: Chart.js, MIT licence (in the source of this page).</footer>\n";
  out += "<script id=\"report-data\" type=\"application/json\">" + data + "</script>\n";
  out += "<script>" + std::string(chart_js()) + "</script>\n<script>" + script + "</script>\n</body>\n</html>\n";
  return out;
}

}  // namespace libchar
