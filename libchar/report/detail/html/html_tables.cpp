#include "libchar/report/detail/html/html_tables.hpp"

#include <fmt/format.h>

#include "libchar/core/text/term_cells.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {

std::string table_row(const std::vector<std::string>& cells) {
  std::string out = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    out += i == 0 ? "<th scope=\"row\">" + html_text(cells[i]) + "</th>"
                  : "<td>" + html_text(cells[i]) + "</td>";
  }
  return out + "</tr>\n";
}

std::string table_head(const std::vector<std::string>& cells) {
  std::string out = "<thead><tr>";
  for (const std::string& cell : cells) out += "<th scope=\"col\">" + html_text(cell) + "</th>";
  return out + "</tr></thead>\n<tbody>\n";
}

std::string card_cell(std::string_view label, const std::string& html, std::string_view css_class) {
  return fmt::format("<td{}{}{} data-label=\"{}\">{}</td>",
                     css_class.empty() ? "" : " class=\"",
                     css_class,
                     css_class.empty() ? "" : "\"",
                     html_attribute(label),
                     html);
}

std::string interval_span(const ShownValue& shown) {
  return shown.low.empty()
             ? ""
             : "<span class=\"ci\">" + html_text(interval_brackets(shown)) + "</span>";
}

std::string folded(const std::string& summary, const std::string& body, bool open) {
  return fmt::format(
      "<details{}><summary>{}</summary>\n{}</details>\n", open ? " open" : "", summary, body);
}

std::string rating_badge(Rating rating) {
  const char* sign = rating == Rating::good ? "✓" : rating == Rating::caution ? "!" : "✗";
  return fmt::format(
      "<span class=\"badge {}\">{} {}</span>", name_of(rating), sign, rating_word(rating));
}

namespace {

std::string finding_item(const Finding& one) {
  std::string out = fmt::format("<li class=\"{}\" title=\"{}\">", name_of(one.severity), one.code) +
                    html_text(one.sentence);
  for (const Finding::Help& help : one.help)
    out += " <span class=\"help\">" + html_text(help.sentence) + "</span>";
  return out + "</li>\n";
}

}  // namespace

std::string findings_list(const std::vector<Finding>& findings) {
  constexpr std::size_t kShown = 5;
  std::string shown, rest;
  for (std::size_t i = 0; i < findings.size(); ++i)
    (i < kShown ? shown : rest) += finding_item(findings[i]);
  if (shown.empty()) return "";
  const auto list = [](const std::string& items) {
    return "<ul class=\"findings\">\n" + items + "</ul>\n";
  };
  return list(shown) +
         (rest.empty() ? "" : folded(fmt::format("{} more", findings.size() - kShown), list(rest)));
}

std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class) {
  if (items.empty()) return "";
  std::string out = fmt::format("<ul class=\"{}\">\n", css_class);
  for (const std::string& item : items) out += "<li>" + html_text(item) + "</li>\n";
  return out + "</ul>\n";
}

}  // namespace libchar
