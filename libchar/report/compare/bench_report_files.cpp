#include "libchar/report/compare/bench_report_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/bench_view.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/svg/svg_points.hpp"

namespace libchar {
namespace {

std::string section_html(const BenchSection& section) {
  std::string out = "<section class=\"channel\">\n<h2>" + html_text(section.title) + "</h2>\n";
  for (const std::string& sentence : section.sentences)
    out += "<p>" + html_text(sentence) + "</p>\n";
  for (const BenchChart& chart : section.charts) out += svg_points(chart, section.title);
  if (!section.heads.empty()) {
    out += "<div class=\"wide\"><table class=\"many\">\n" + table_head(section.heads);
    for (const auto& row : section.rows) out += table_row(row);
    out += "</tbody></table></div>\n";
  }
  for (const std::string& note : section.notes)
    out += "<p class=\"note\">" + html_text(note) + "</p>\n";
  return out + "</section>\n";
}

std::string markdown_row(const std::vector<std::string>& cells) {
  std::string out = "|";
  for (const std::string& cell : cells) out += " " + markdown_text(cell) + " |";
  return out + "\n";
}

}  // namespace

std::string bench_text(const BenchReport& report) {
  std::string out;
  for (const BenchSection& section : bench_view(report)) {
    out += printable(section.title) + "\n";
    for (const std::string& sentence : section.sentences) out += "  " + printable(sentence) + "\n";
    if (!section.heads.empty()) {
      std::vector<std::vector<std::string>> rows = {section.heads};
      rows.insert(rows.end(), section.rows.begin(), section.rows.end());
      for (auto& row : rows)
        for (std::string& cell : row) cell = printable(cell);
      out += text_table(rows, "  ", true);
    }
    out += "\n";
  }
  return out;
}

std::string bench_markdown(const BenchReport& report) {
  std::string out = "# Benchmarks\n";
  for (const BenchSection& section : bench_view(report)) {
    out += "\n## " + markdown_text(section.title) + "\n\n";
    for (const std::string& sentence : section.sentences) out += markdown_text(sentence) + "\n";
    if (!section.heads.empty()) {
      out += (section.sentences.empty() ? "" : "\n") + markdown_row(section.heads) +
             markdown_row(std::vector<std::string>(section.heads.size(), "---"));
      for (const auto& row : section.rows) out += markdown_row(row);
    }
    for (const std::string& note : section.notes) out += "\n" + markdown_text(note) + "\n";
  }
  return out;
}

std::string bench_html(const BenchReport& report) {
  std::string body;
  for (const BenchSection& section : bench_view(report)) body += section_html(section);
  body += "<section class=\"channel\">\n<h2>Provenance</h2>\n<p><code>" +
          html_text(command_line(report.command)) + "</code></p>\n</section>\n";
  return html_page({"Benchmarks",
                    report.quick ? "quick" : "run time against error",
                    "reportPage.start({}, () => 320);\n",
                    std::string(page_css()) + std::string(many_page_css())},
                   body,
                   json_in_script(document_of(bench_fields(), report)));
}

std::vector<OutputFile> bench_files(const BenchReport& report,
                                    const std::filesystem::path& folder) {
  std::vector<OutputFile> out = {{(folder / "bench.html").string(), bench_html(report)},
                                 {(folder / "bench.json").string(), ""},
                                 {(folder / "bench.md").string(), bench_markdown(report)}};
  Json document = document_of(bench_fields(), report);
  name_files(document, out);
  out[1].text = dump_json(document);
  return out;
}

}  // namespace libchar
