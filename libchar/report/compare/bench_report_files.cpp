#include "libchar/report/compare/bench_report_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/bench_view.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/charts.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
namespace {

std::string section_html(const BenchSection& section, std::size_t number) {
  std::string out = fmt::format("<section class=\"channel\" id=\"part-{}\">\n<h2>{}</h2>\n",
                                number,
                                html_text(section.title));
  for (const std::string& sentence : section.sentences)
    out += "<p>" + html_text(sentence) + "</p>\n";
  for (const BenchChart& chart : section.charts) out += points_figure(chart, section.title);
  if (!section.table.columns.empty()) out += html_table(section.table, {.css = "many"});
  for (const std::string& note : section.notes)
    out += "<p class=\"note\">" + html_text(note) + "</p>\n";
  return out + "</section>\n";
}

}  // namespace

std::string bench_text(const BenchReport& report) {
  std::string out;
  for (const std::string& sentence : detail::bench_verdict(report))
    out += printable(sentence) + "\n";
  if (!out.empty()) out += "\n";
  for (const BenchSection& section : bench_view(report)) {
    out += printable(section.title) + "\n";
    for (const std::string& sentence : section.sentences) out += "  " + printable(sentence) + "\n";
    if (!section.table.columns.empty()) out += terminal_table(section.table);
    out += "\n";
  }
  return out;
}

std::string bench_markdown(const BenchReport& report) {
  std::string out = "# Benchmarks\n\n";
  for (const std::string& sentence : detail::bench_verdict(report))
    out += markdown_text(sentence) + "\n";
  for (const BenchSection& section : bench_view(report)) {
    out += "\n## " + markdown_text(section.title) + "\n\n";
    for (const std::string& sentence : section.sentences) out += markdown_text(sentence) + "\n";
    if (!section.table.columns.empty())
      out += (section.sentences.empty() ? "" : "\n") + table_text(section.table);
    for (const std::string& note : section.notes) out += "\n" + markdown_text(note) + "\n";
  }
  return out;
}

std::string bench_html(const BenchReport& report) {
  const std::vector<BenchSection> sections = bench_view(report);
  std::string body = "<div class=\"verdict\">\n", contents, parts;
  for (const std::string& sentence : detail::bench_verdict(report))
    body += "<p>" + html_text(sentence) + "</p>\n";
  for (std::size_t i = 0; i < sections.size(); ++i) {
    contents +=
        fmt::format("<li><a href=\"#part-{}\">{}</a></li>\n", i + 1, html_text(sections[i].title));
    parts += section_html(sections[i], i + 1);
  }
  body += "</div>\n<ul class=\"contents\">\n" + contents + "</ul>\n" + parts;
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
