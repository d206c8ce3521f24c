#include "libchar/report/compare/bench_report_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/benchmark/bench_view.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/charts.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {
namespace {

Json figure_json(const Figure& figure) {
  return {{"value", json_number(figure.value)},
          {"ci95", interval_json(figure.ci95)},
          {"count", figure.count}};
}

Json machine_json(const Machine& m) {
  return {{"processor", json_text(m.processor)},
          {"processors", m.cores},
          {"memory_gib", json_number(m.memory_gib)},
          {"system", json_text(m.system)},
          {"busy_with_others", json_number(m.others)},
          {"wall_s", json_number(m.wall_s)},
          {"cpu_s", json_number(m.cpu_s)}};
}

Json method_json(const EstimatorAccuracy& method) {
  Json terms = Json::array();
  for (const TermAccuracy& term : method.terms)
    terms.push_back({{"term", std::string(kTermNames[static_cast<std::size_t>(term.term)].key)},
                     {"truth", json_number(term.truth)},
                     {"bound", json_number(term.bound)},
                     {"rmse_over_bound", figure_json(term.error)},
                     {"bias_over_bound", json_number(term.bias)},
                     {"coverage", figure_json(term.coverage)}});
  return {{"name", method.name},
          {"what", method.what},
          {"of_this_program", method.is_ours},
          {"terms", std::move(terms)},
          {"error", json_number(method.error)},
          {"false_terms", figure_json(method.false_terms)},
          {"ns_per_sample", figure_json(method.ns_per_sample)},
          {"time_ratio", figure_json(method.time_ratio)},
          {"bytes_per_sample", json_number(method.bytes_per_sample)},
          {"front_gap", json_number(method.front_gap)}};
}

Json characterization_json(const CharacterizationBench& bench) {
  Json out = {{"signal", json_text(bench.signal.name)},
              {"rate_hz", json_number(bench.signal.rate_hz)},
              {"samples", bench.signal.samples},
              {"records", bench.records},
              {"seed", bench.seed},
              {"methods", Json::array()},
              {"notes", bench.notes}};
  for (const EstimatorAccuracy& method : bench.methods)
    out["methods"].push_back(method_json(method));
  return out;
}

Json cell_json(const FusionBenchCell& cell) {
  if (!cell.ran) return {{"ran", false}, {"why", json_text(cell.why)}};
  return {{"ran", true},
          {"excess", figure_json(cell.excess)},
          {"ns_per_instant", figure_json(cell.ns_per_sample)},
          {"learning_s", json_number(cell.learning_s)},
          {"bytes", json_number(cell.bytes)}};
}

Json fusion_json(const FusionBench& bench) {
  Json out = {{"seed", bench.seed}, {"scenes", Json::array()}, {"methods", Json::array()}};
  for (const FusionBenchLeftOut& scene : bench.left_out)
    out["left_out"].push_back({{"name", json_text(scene.name)},
                               {"file", json_text(scene.file)},
                               {"why", json_text(scene.why)}});
  for (const FusionBenchScene& scene : bench.scenes)
    out["scenes"].push_back({{"name", json_text(scene.name)},
                             {"file", json_text(scene.file)},
                             {"yardstick", scene.yardstick},
                             {"instants", scene.instants},
                             {"sensors", scene.sensors},
                             {"inputs", scene.inputs},
                             {"simulated", scene.simulated},
                             {"runs", scene.runs},
                             {"pooled", scene.pooled}});
  for (std::size_t i = 0; i < bench.rows.size(); ++i) {
    const FusionBenchRow& row = bench.rows[i];
    Json cells = Json::array();
    for (std::size_t s = 0; s < row.cells.size(); ++s) {
      cells.push_back(cell_json(row.cells[s]));
      cells.back()["front_gap"] = json_number(bench.scenes[s].front_gaps[i]);
    }
    out["methods"].push_back({{"label", json_text(row.label)},
                              {"algorithm", row.name},
                              {"bound", row.bound},
                              {"swept", row.swept},
                              {"excess", figure_json(row.excess)},
                              {"ns_per_instant", figure_json(row.ns_per_sample)},
                              {"front_gap", json_number(row.front_gap)},
                              {"scenes", std::move(cells)}});
  }
  return out;
}

Json scaling_json(const ScalingBench& bench) {
  Json out = {{"rate_hz", json_number(bench.rate_hz)}, {"series", Json::array()}};
  for (const ScalingSeries& series : bench.series) {
    Json points = Json::array();
    for (const ScalingPoint& point : series.points)
      points.push_back({{"x", json_number(point.x)},
                        {"cost", figure_json(point.cost)},
                        {"bytes", json_number(point.bytes)}});
    out["series"].push_back({{"name", series.name},
                             {"over", series.over},
                             {"unit", series.unit},
                             {"points", std::move(points)},
                             {"exponent", figure_json(series.exponent)},
                             {"keeps_up_to", json_number(series.keeps_up_to)}});
  }
  return out;
}

Json design_json(const DesignBench& bench) {
  Json out = {{"target", json_number(bench.options.target)},
              {"tau_s", json_number(bench.options.tau_s)},
              {"share", json_number(bench.options.share)},
              {"one_of_each", json_number(bench.one_of_each)},
              {"sensors", Json::array()},
              {"records", Json::array()}};
  for (const SensorsNeeded& row : bench.sensors)
    out["sensors"].push_back({{"model", json_text(row.model)},
                              {"single", json_number(row.single)},
                              {"sensors", row.sensors},
                              {"predicted", json_number(row.predicted)},
                              {"simulated", figure_json(row.simulated)}});
  for (const RecordNeeded& row : bench.records)
    out["records"].push_back(
        {{"model", json_text(row.model)},
         {"term", std::string(kTermNames[static_cast<std::size_t>(row.term)].key)},
         {"seconds", json_number(row.seconds)},
         {"samples", json_number(row.samples)},
         {"simulated", figure_json(row.simulated)}});
  return out;
}

Json stress_json(const StressBench& bench) {
  Json out = {{"seed", bench.seed}, {"cells", Json::array()}};
  for (const StressOutcome outcome :
       {StressOutcome::digits, StressOutcome::held, StressOutcome::refused, StressOutcome::wrong})
    out[std::string(name_of(outcome))] = bench.count(outcome);
  for (const StressCell& cell : bench.cells)
    out["cells"].push_back({{"of", cell.subject},
                            {"input", cell.input},
                            {"outcome", std::string(name_of(cell.outcome))},
                            {"digits", json_number(cell.digits)},
                            {"stated", json_number(cell.stated)},
                            {"what", json_text(cell.what)}});
  return out;
}

std::string section_html(const BenchSection& section) {
  std::string out = "<section class=\"channel\">\n<h2>" + html_text(section.title) + "</h2>\n";
  for (const std::string& sentence : section.sentences)
    out += "<p>" + html_text(sentence) + "</p>\n";
  for (const BenchChart& chart : section.charts) out += points_figure(chart, section.title);
  if (!section.table.columns.empty()) out += html_table(section.table, {.css = "many"});
  for (const std::string& note : section.notes)
    out += "<p class=\"note\">" + html_text(note) + "</p>\n";
  return out + "</section>\n";
}

}  // namespace

Json bench_json(const BenchReport& report) {
  Json out = json_frame("bench");
  out["command"] = report.command;
  out["quick"] = report.quick;
  out["seed"] = report.seed;
  out["machine"] = machine_json(report.machine);
  out["characterization"] = Json::array();
  for (const CharacterizationBench& bench : report.characterization)
    out["characterization"].push_back(characterization_json(bench));
  out["fusion"] = report.fusion ? fusion_json(*report.fusion) : Json(nullptr);
  out["scaling"] = report.scaling ? scaling_json(*report.scaling) : Json(nullptr);
  out["design"] = report.design ? design_json(*report.design) : Json(nullptr);
  out["stress"] = report.stress ? stress_json(*report.stress) : Json(nullptr);
  return out;
}

std::string bench_text(const BenchReport& report) {
  std::string out;
  for (const BenchSection& section : bench_view(report)) {
    out += printable(section.title) + "\n";
    for (const std::string& sentence : section.sentences) out += "  " + printable(sentence) + "\n";
    if (!section.table.columns.empty()) out += terminal_table(section.table);
    out += "\n";
  }
  return out;
}

std::string bench_markdown(const BenchReport& report) {
  std::string out = "# Benchmarks\n";
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
  std::string body;
  for (const BenchSection& section : bench_view(report)) body += section_html(section);
  body += "<section class=\"channel\">\n<h2>Provenance</h2>\n<p><code>" +
          html_text(command_line(report.command)) + "</code></p>\n</section>\n";
  return html_page({"Benchmarks",
                    report.quick ? "quick" : "run time against error",
                    "reportPage.start({}, () => 320);\n",
                    std::string(page_css()) + std::string(many_page_css())},
                   body,
                   json_in_script(bench_json(report)));
}

std::vector<OutputFile> bench_files(const BenchReport& report,
                                    const std::filesystem::path& folder) {
  std::vector<OutputFile> out = {{(folder / "bench.html").string(), bench_html(report)},
                                 {(folder / "bench.json").string(), ""},
                                 {(folder / "bench.md").string(), bench_markdown(report)}};
  Json document = bench_json(report);
  name_files(document, out);
  out[1].text = dump_json(document);
  return out;
}

}  // namespace libchar
