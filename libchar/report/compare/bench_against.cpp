#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/document/fields.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/charts.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/report_rows.hpp"

namespace libchar {
namespace {

/// Times may be worse by so many tolerances: an interval within a run does not hold what differs from run to run.
constexpr double kTimeTolerance = 3;

struct Named {
  std::string what;
  bool is_time = false;
  Figure figure;
};

void add(std::vector<Named>& out, const std::string& what, bool is_time, const Figure& figure) {
  if (figure.count > 0 && !std::isnan(figure.value)) out.push_back({what, is_time, figure});
}

std::vector<Named> figures_in(const BenchReport& report) {
  std::vector<Named> out;
  for (const CharacterizationBench& bench : report.characterization)
    for (const EstimatorAccuracy& method : bench.methods) {
      const std::string who = "noise coefficients, " + bench.signal.name + ": " + method.name + ", ";
      for (const TermAccuracy& term : method.terms)
        add(out, fmt::format("{}RMSE of {}", who, kTermNames[static_cast<std::size_t>(term.term)].key), false,
            term.error);
      add(out, who + "ns per sample", true, method.ns_per_sample);
    }
  for (const FusionBenchRow& method : report.fusion ? report.fusion->rows : std::vector<FusionBenchRow>{}) {
    const std::string who = "fusion: " + method.label + ", ";
    Figure excess = method.excess;
    // As a ratio: an excess of zero has none.
    excess.value += 1, excess.ci95.low += 1, excess.ci95.high += 1;
    add(out, who + "RMSE over yardstick", false, excess);
    add(out, who + "ns per instant", true, method.ns_per_sample);
  }
  for (const ScalingSeries& series : report.scaling ? report.scaling->series : std::vector<ScalingSeries>{})
    if (!series.points.empty())
      add(out, fmt::format("growth over {}: {}, at {}", series.over, series.name, series.points.back().x), true,
          series.points.back().cost);
  return out;
}

Cell state_of(const BenchChange& c) {
  if (c.was.value == c.now.value) return "the same";
  return c.ratio > 1 ? Cell::word("worse", Tint::bad) : Cell::word("better", Tint::good);
}

Table changes_table(const BenchChanges& changes) {
  Table out("figure|was|now|ratio|");
  out.title = "Against the older run";
  for (const BenchChange& c : changes.figures)
    if (c.resolved)
      out.add({c.what, figure_text(c.was), figure_text(c.now), fmt::format("{:.3f}", c.ratio), state_of(c)});
  return out;
}

}  // namespace

std::vector<BenchChange> BenchChanges::worse(double tolerance) const {
  std::vector<BenchChange> out;
  for (const BenchChange& c : figures)
    if (c.resolved && c.ratio > 1 + (c.is_time ? kTimeTolerance : 1) * tolerance && (same_machine || !c.is_time))
      out.push_back(c);
  return out;
}

BenchChanges bench_changes(const BenchReport& was, const BenchReport& now, const std::string& file) {
  BenchChanges out;
  out.same_machine = was.machine.processor == now.machine.processor && was.machine.cores == now.machine.cores;
  std::map<std::string, Named> current;
  for (Named& named : figures_in(now)) current.emplace(named.what, named);
  for (const Named& named : figures_in(was)) {
    const auto found = current.find(named.what);
    if (found == current.end()) {
      out.missing.push_back(named.what);
      continue;
    }
    BenchChange change{named.what, named.is_time, named.figure, found->second.figure};
    change.ratio = change.now.value / change.was.value;
    change.resolved = !unresolved(change.was, change.now);
    out.figures.push_back(std::move(change));
  }
  if (out.figures.empty())
    throw input_error("E0968", file).says("no figure of this run is in it").hint("run the same files and parts");
  return out;
}

std::string changes_text(const BenchChanges& changes, double tolerance) {
  const Table table = changes_table(changes);
  std::string out = table.rows.empty() ? table.title + "\n" : terminal_table(table);
  out += fmt::format("  {} of {} figures: no difference resolved\n", changes.figures.size() - table.rows.size(),
                     changes.figures.size());
  if (!changes.missing.empty()) out += fmt::format("  {} figures are in the older run only\n", changes.missing.size());
  if (!changes.same_machine) out += "  another machine: times are shown but not judged\n";
  return out + fmt::format("  worse by more than {} %: {}\n\n", 100 * tolerance, changes.worse(tolerance).size());
}

Json changes_json(const BenchChanges& changes, double tolerance) {
  static const Fields<BenchChange> rows = always(Fields<BenchChange>{
      field<&BenchChange::what>("what"),
      field<&BenchChange::is_time>("time"),
      field<&BenchChange::was, &Figure::value>("was"),
      field<&BenchChange::now, &Figure::value>("now"),
      field<&BenchChange::ratio>("ratio"),
      field<&BenchChange::resolved>("resolved"),
  });
  Json out = {{"same_machine", changes.same_machine},
              {"tolerance", json_number(tolerance)},
              {"worse", changes.worse(tolerance).size()},
              {"missing", texts_json(changes.missing)},
              {"figures", Json::array()}};
  for (const BenchChange& c : changes.figures) out["figures"].push_back(document_of(rows, c));
  return out;
}

namespace {

std::string section_html(const BenchSection& section, std::size_t number) {
  std::string out =
      fmt::format("<section class=\"channel\" id=\"part-{}\">\n<h2>{}</h2>\n", number, html_text(section.title));
  for (const std::string& sentence : section.sentences) out += "<p>" + html_text(sentence) + "</p>\n";
  for (const BenchChart& chart : section.charts) out += points_figure(chart, section.title);
  if (!section.table.columns.empty()) out += html_table(section.table, {.css = "many cards", .cards = true});
  for (const std::string& note : section.notes) out += "<p class=\"note\">" + html_text(note) + "</p>\n";
  return out + "</section>\n";
}

}  // namespace

std::string bench_text(const BenchReport& report) {
  std::string out;
  for (const std::string& sentence : detail::bench_verdict(report)) out += printable(sentence) + "\n";
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
  for (const std::string& sentence : detail::bench_verdict(report)) out += markdown_text(sentence) + "\n";
  for (const BenchSection& section : bench_view(report)) {
    out += "\n## " + markdown_text(section.title) + "\n\n";
    for (const std::string& sentence : section.sentences) out += markdown_text(sentence) + "\n";
    if (!section.table.columns.empty()) out += (section.sentences.empty() ? "" : "\n") + table_text(section.table);
    for (const std::string& note : section.notes) out += "\n" + markdown_text(note) + "\n";
  }
  return out;
}

std::string bench_html(const BenchReport& report, const std::vector<std::string>& next) {
  const std::vector<BenchSection> sections = bench_view(report);
  std::string body = "<div class=\"verdict\">\n", contents, parts;
  for (const std::string& sentence : detail::bench_verdict(report)) body += "<p>" + html_text(sentence) + "</p>\n";
  for (std::size_t i = 0; i < sections.size(); ++i) {
    contents += fmt::format("<li><a href=\"#part-{}\">{}</a></li>\n", i + 1, html_text(sections[i].title));
    parts += section_html(sections[i], i + 1);
  }
  body += "</div>\n" + next_part(next) + "<ul class=\"contents\">\n" + contents + "</ul>\n" + parts;
  body += "<section class=\"channel\">\n<h2>Provenance</h2>\n<p><code>" + html_text(command_line(report.command)) +
          "</code></p>\n</section>\n";
  return html_page({"Benchmarks", report.quick ? "quick" : "run time against error",
                    "reportPage.start({}, () => 320);\n", std::string(page_css()) + std::string(many_page_css())},
                   body, json_in_script(document_of(bench_fields(), report)));
}

std::vector<OutputFile> bench_files(const BenchReport& report, const std::filesystem::path& folder,
                                    const std::vector<std::string>& next) {
  std::vector<OutputFile> out = {{(folder / "bench.html").string(), bench_html(report, next)},
                                 {(folder / "bench.json").string(), ""},
                                 {(folder / "bench.md").string(), bench_markdown(report)}};
  Json document = document_of(bench_fields(), report);
  name_files(document, out);
  out[1].text = dump_json(document);
  return out;
}

}  // namespace libchar
