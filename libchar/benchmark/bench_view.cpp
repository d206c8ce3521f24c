#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"

namespace libchar {
namespace {

std::string gap_text(double gap) {
  if (std::isnan(gap)) return "–";
  return gap <= 0 ? "on the front" : excess_text(gap) + (gap < 1 ? " above" : "");
}

std::string bytes_cell(const std::optional<double>& bytes) { return bytes ? number_text(*bytes, 3) : "–"; }

BenchSection machine_section(const BenchReport& report) {
  const Machine& m = report.machine;
  BenchSection out;
  out.title = "Machine";
  out.sentences = {fmt::format("{}, {} processors, {} GiB, {}; {} of this run, {} of processor time; seed {}{}.",
                               m.processor, m.cores, brief_text(m.memory_gib, 3), m.system, duration_text(m.wall_s),
                               duration_text(m.cpu_s), report.seed,
                               report.quick ? "; quick: short records, few runs" : "")};
  if (const std::string load = load_sentence(m); !load.empty()) out.sentences.push_back(load);
  return out;
}

std::string term_cell(const EstimatorAccuracy& method, std::size_t term) {
  return figure_text(method.terms[term].error);
}

std::string coverage_cell(const EstimatorAccuracy& method) {
  std::string out;
  for (const TermAccuracy& term : method.terms) {
    if (term.coverage.count == 0) continue;
    out += fmt::format("{}{} {:.0f}", out.empty() ? "" : ", ", kTermNames[static_cast<std::size_t>(term.term)].letter,
                       100 * term.coverage.value);
  }
  return out.empty() ? "no intervals" : out + " %";
}

BenchChart chart_of(const CharacterizationBench& bench) {
  BenchChart chart{"processor time, ns per sample", "RMSE over the bound, geometric mean", {}};
  for (const EstimatorAccuracy& method : bench.methods)
    chart.points.push_back({method.name,
                            method.ns_per_sample.value,
                            method.error,
                            method.ns_per_sample.ci95,
                            {-INFINITY, INFINITY},
                            method.front_gap <= 0,
                            method.is_ours,
                            method.told});
  return chart;
}

BenchSection section_of(const CharacterizationBench& bench) {
  BenchSection out;
  out.title = "Noise coefficients: " + bench.signal.name;
  std::string truth;
  for (const TermAccuracy& term : bench.methods.front().terms)
    truth += fmt::format("{} = {} (bound {}), ", kTermNames[static_cast<std::size_t>(term.term)].letter,
                         number_text(term.truth, 3), percent_text(term.bound / term.truth));
  out.sentences = {fmt::format("{}{} simulated records of {} samples at {}.", truth, bench.records,
                               count_text(bench.signal.samples), detail::frequency_text(bench.signal.rate_hz, 4))};
  out.sentences.insert(out.sentences.end(), bench.notes.begin(), bench.notes.end());
  out.table = Table("Method");
  for (const TermAccuracy& term : bench.methods.front().terms)
    out.table.columns.push_back(
        {fmt::format("RMSE / bound, {}", kTermNames[static_cast<std::size_t>(term.term)].letter)});
  Table rest("Coverage of 95 %|False terms|Time per sample, ns|Time over the first|Memory per sample, bytes|Front");
  for (Table::Column& column : rest.columns) out.table.columns.push_back(std::move(column));
  std::vector<const EstimatorAccuracy*> order;
  for (const EstimatorAccuracy& method : bench.methods) order.push_back(&method);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return a->error < b->error; });
  for (const EstimatorAccuracy* method : order) {
    std::vector<Cell> row = {method->name};
    for (std::size_t t = 0; t < method->terms.size(); ++t) row.push_back(term_cell(*method, t));
    row.push_back(coverage_cell(*method));
    row.push_back(method->false_terms.count == 0 ? "–" : percent_text(method->false_terms.value));
    row.push_back(figure_text(method->ns_per_sample));
    row.push_back(figure_text(method->time_ratio));
    row.push_back(bytes_cell(method->bytes_per_sample));
    row.push_back(gap_text(method->front_gap));
    out.table.add(std::move(row));
  }
  out.charts = {chart_of(bench)};
  return out;
}

/// "Gyroscope: whittle is most exact, 1.1 × the bound, 74 ns per sample; of others' recipes imu_utils, 4.9 ×."
std::string verdict_of(const CharacterizationBench& bench) {
  const auto best = [&](bool ours) -> const EstimatorAccuracy* {
    const EstimatorAccuracy* out = nullptr;
    for (const EstimatorAccuracy& m : bench.methods)
      if (m.is_ours == ours && !m.told && m.error > 0 && (out == nullptr || m.error < out->error)) out = &m;
    return out;
  };
  const EstimatorAccuracy *ours = best(true), *others = best(false);
  if (ours == nullptr) return "";
  std::string out = fmt::format(
      "{}: of the methods that choose the terms themselves, {} is the most accurate, {} × the bound at {} ns per "
      "sample",
      bench.signal.name, ours->name, number_text(ours->error, 3), number_text(ours->ns_per_sample.value, 3));
  if (others != nullptr)
    out += fmt::format("; the best recipe of others, {}, {} ×", others->name, number_text(others->error, 3));
  return out + ".";
}

std::string verdict_of(const FusionBench& bench) {
  const FusionBenchRow* best = nullptr;
  for (const FusionBenchRow& row : bench.rows)
    if (!row.bound && row.excess.count > 0 && (best == nullptr || row.excess.value < best->excess.value)) best = &row;
  return best == nullptr ? ""
                         : fmt::format("Fusion: {} has the smallest error over all scenes, {} × that of the yardstick.",
                                       best->label, number_text(1 + best->excess.value, 3));
}

BenchSection legend_section(const CharacterizationBench& bench) {
  BenchSection out;
  out.title = "The methods";
  out.table = Table("Method|What it does");
  for (const EstimatorAccuracy& method : bench.methods) out.table.add({method.name, method.what});
  out.notes = {
      "Bound: the Cramér-Rao bound, the smallest standard deviation that an unbiased method can reach on such a "
      "recording. RMSE over it: 1 is the best possible; a coefficient that is in the records and not detected counts "
      "as an estimate of "
      "zero. Where the bound is wide, zero can be nearer than the bound says. False terms: records in which a "
      "coefficient is stated that is not in them (–: its terms are given, or all are there). Time over the first: of "
      "the first method listed below, record by record. Methods that are given the terms count against each other "
      "only. A "
      "coefficient whose bound is wider than half of it is not in the mean used by the front and the chart. Front: no "
      "method is at least as fast and more exact; otherwise by how much the best such method is more exact."};
  return out;
}

std::string scene_cell(const FusionBenchCell& cell) { return cell.ran ? figure_text(cell.excess, 3, 100) : "–"; }

std::vector<Cell> row_cells(const FusionBenchRow& row) {
  std::vector<Cell> out = {row.label + (row.bound ? " (bound)" : "")};
  out.push_back(row.excess.count == 0 ? "–" : figure_text(row.excess, 3, 100));
  for (const FusionBenchCell& cell : row.cells) out.push_back(scene_cell(cell));
  out.push_back(figure_text(row.ns_per_sample));
  std::optional<double> bytes;
  for (const FusionBenchCell& cell : row.cells)
    if (cell.bytes) bytes = std::max(bytes.value_or(0), *cell.bytes);
  out.push_back(bytes_cell(bytes));
  out.push_back(row.bound ? "–" : gap_text(row.front_gap));
  return out;
}

BenchSection over_all(const FusionBench& bench) {
  BenchSection out;
  out.title = "Fusion: over the scenes";
  out.table = Table("Method|Excess over all, %");
  for (std::size_t s = 0; s < bench.scenes.size(); ++s) {
    const FusionBenchScene& scene = bench.scenes[s];
    out.table.columns.push_back({fmt::format("scene {}", s + 1)});
    out.sentences.push_back(
        fmt::format("Scene {}: {}; {} sensors, {} true {}, {} instants, {} runs{}; yardstick: {}.", s + 1, scene.name,
                    scene.sensors, scene.inputs, scene.inputs == 1 ? "input" : "inputs", count_text(scene.instants),
                    scene.runs, scene.pooled ? "" : " (another kind, not in the means over all)", scene.yardstick));
  }
  for (const FusionBenchLeftOut& scene : bench.left_out)
    out.sentences.push_back(fmt::format("Left out: {}; {}.", scene.name, scene.why));
  for (const char* head : {"Time per instant, ns", "Memory at most, bytes", "Front"})
    out.table.columns.push_back({head});
  BenchChart chart{"processor time, ns per instant", "RMSE over the yardstick's", {}};
  for (const FusionBenchRow& row : bench.rows) {
    const bool anywhere =
        std::any_of(row.cells.begin(), row.cells.end(), [](const FusionBenchCell& cell) { return cell.ran; });
    if (!anywhere) continue;
    out.table.add(row_cells(row));
    if (row.bound || row.excess.count == 0 || row.ns_per_sample.count == 0) continue;
    chart.points.push_back({row.label,
                            row.ns_per_sample.value,
                            1 + row.excess.value,
                            row.ns_per_sample.ci95,
                            {1 + row.excess.ci95.low, 1 + row.excess.ci95.high},
                            row.front_gap <= 0,
                            true});
  }
  out.notes = {
      "–: does not run on this scene. Excess: RMSE over the yardstick's, minus one; mean over the runs and its 95 % "
      "interval by Student's t. Times: median over the runs and the order statistics that hold it with 95 %. Over all: "
      "geometric means over the scenes of the most frequent kind."};
  if (chart.points.size() > 1) out.charts = {chart};
  return out;
}

std::string at_text(const std::string& over, double x) {
  return over == "samples" ? number_text(x, 3) : brief_text(x, 6);
}

/// Growth over one quantity: a column a point of the smallest, a middle and the largest.
BenchSection growth_section(const ScalingBench& bench, const std::string& over) {
  BenchSection out;
  out.title = "Growth of cost over " + over;
  const bool sensors = over == "sensors";
  out.table = Table("Work|at the least|at the most|Memory at the most|Exponent");
  if (sensors)
    out.table.columns.push_back({fmt::format("Keeps up to, at {}", detail::frequency_text(bench.rate_hz, 3))});
  for (const ScalingSeries& series : bench.series) {
    if (series.over != over || series.points.empty()) continue;
    const ScalingPoint &least = series.points.front(), &most = series.points.back();
    const auto cell = [&](const ScalingPoint& p) {
      return fmt::format("{}: {} {}", at_text(over, p.x), figure_text(p.cost), series.unit);
    };
    std::vector<Cell> row = {series.name, cell(least), cell(most),
                             most.bytes ? bytes_text(static_cast<std::uint64_t>(*most.bytes)) : "–",
                             figure_text(series.exponent, 3)};
    if (sensors)
      row.push_back(!series.keeps_up_to          ? "–"
                    : *series.keeps_up_to >= 1e6 ? "10⁶ and more"
                                                 : number_text(std::floor(*series.keeps_up_to), 3));
    out.table.add(std::move(row));
  }
  if (over == "samples")
    out.notes = {"Exponent p of time ~ samplesᵖ over the last three octaves, 95 % interval by Student's t."};
  if (sensors)
    out.notes = {
        "One true input. Keeps up to: the number of sensors that takes one whole processor at that rate (extrapolated "
        "beyond the largest number tried). With more sensors this method does not keep up on one processor."};
  return out;
}

BenchSection sensors_section(const DesignBench& bench) {
  BenchSection out;
  out.title = "Design: how many sensors";
  out.sentences = {fmt::format("Asked for: an Allan deviation of {} at {} of averaging.",
                               number_text(*bench.options.target, 4), duration_text(bench.options.tau_s))};
  if (bench.one_of_each)
    out.sentences.push_back(
        fmt::format("One of each together, weighted: {}{}.", number_text(*bench.one_of_each, 4),
                    *bench.one_of_each <= *bench.options.target ? ", which does" : ", which does not do"));
  out.table = Table("Model|One has|Needed|They have|Simulated");
  for (const SensorsNeeded& row : bench.sensors)
    out.table.add({row.model, number_text(row.single, 4), count_text(row.sensors), number_text(row.predicted, 4),
                   row.simulated.count == 0 ? "too long to check" : figure_text(row.simulated)});
  out.notes = {
      "For independent sensors: errors that they share (temperature, supply, a common clock) do not fall with their "
      "number."};
  return out;
}

BenchSection records_section(const DesignBench& bench) {
  BenchSection out;
  out.title = "Design: how long a record";
  out.sentences = {
      fmt::format("Each coefficient to {} of itself (one standard deviation).", percent_text(bench.options.share))};
  out.table = Table("Model|Coefficient|Record|Samples|Simulated, %");
  for (const RecordNeeded& row : bench.records)
    out.table.add({row.model, std::string(kTermNames[static_cast<std::size_t>(row.term)].letter),
                   row.seconds ? duration_text(*row.seconds) : "none is long enough",
                   row.seconds ? number_text(row.samples, 3) : "–",
                   row.simulated.count == 0 ? "not checked" : figure_text(row.simulated, 3, 100)});
  out.notes = {
      "By the Cramér-Rao bound; simulated: the relative RMSE of the Whittle likelihood on records of that length."};
  return out;
}

std::string digits_text(const StressCell& cell) { return std::isnan(cell.digits) ? "–" : number_text(cell.digits, 3); }

/// A row a subject, in the order of its worst cell.
BenchSection stress_section(const StressBench& bench) {
  BenchSection out;
  out.title = "Stress: digits that are right, worst first";
  out.sentences = {fmt::format(
      "{} hard inputs and subjects: {} compared with a reference, {} held, {} refused in a sentence, {} wrong.",
      bench.cells.size(), bench.count(StressOutcome::digits), bench.count(StressOutcome::held),
      bench.count(StressOutcome::refused), bench.count(StressOutcome::wrong))};
  for (const StressCell& cell : bench.cells)
    if (cell.outcome == StressOutcome::wrong)
      out.sentences.push_back(fmt::format("Wrong: {}, {}: {}.", cell.subject, cell.input, cell.what));
  out.table = Table("Of|Digits|Stated|Worst input|Compared|Held|Refused");
  std::vector<std::string> seen;
  for (const StressCell& cell : bench.cells) {
    if (std::find(seen.begin(), seen.end(), cell.subject) != seen.end()) continue;
    seen.push_back(cell.subject);
    StressBench own;
    for (const StressCell& other : bench.cells)
      if (other.subject == cell.subject) own.cells.push_back(other);
    const auto count = [&](StressOutcome outcome) { return std::to_string(own.count(outcome)); };
    out.table.add({cell.subject, digits_text(cell), std::isnan(cell.stated) ? "–" : number_text(cell.stated, 2),
                   std::isnan(cell.digits) ? "–" : cell.input, count(StressOutcome::digits), count(StressOutcome::held),
                   count(StressOutcome::refused)});
  }
  out.notes = {
      "Compared: estimators with their definitions in long double, weights with a QR decomposition in long double, "
      "fits and fusion with themselves on the same samples in comfortable numbers; of the worst value of a curve, of a "
      "path together. Held: estimates are numbers in the range of what came in, no variance is negative. Methods as "
      "published state nothing. Every cell is in bench.json."};
  return out;
}

BenchSection worst_stress_section(const StressBench& bench) {
  constexpr std::size_t kMost = 40;
  BenchSection out;
  out.title = "Stress: the cells with the fewest digits beyond the stated ones";
  out.table = Table("Of|Input|Digits|Stated");
  for (const StressCell& cell : bench.cells) {
    if (out.table.rows.size() == kMost || std::isnan(cell.stated)) break;
    out.table.add({cell.subject, cell.input, digits_text(cell), number_text(cell.stated, 2)});
  }
  return out;
}

}  // namespace

std::string figure_text(const Figure& figure, int digits, double factor) {
  if (figure.count == 0 || std::isnan(figure.value)) return "–";
  std::string out = number_text(factor * figure.value, digits);
  if (std::isfinite(figure.ci95.low) && std::isfinite(figure.ci95.high))
    out += fmt::format(" [{}, {}]", number_text(factor * figure.ci95.low, digits),
                       number_text(factor * figure.ci95.high, digits));
  return out;
}

std::vector<std::string> detail::bench_verdict(const BenchReport& report) {
  std::vector<std::string> out;
  for (const CharacterizationBench& bench : report.characterization) out.push_back(verdict_of(bench));
  if (report.fusion) out.push_back(verdict_of(*report.fusion));
  if (report.stress)
    out.push_back(fmt::format("Stress: {} of {} results are wrong.", report.stress->count(StressOutcome::wrong),
                              report.stress->cells.size()));
  std::erase(out, "");
  return out;
}

std::vector<BenchSection> bench_view(const BenchReport& report) {
  std::vector<BenchSection> out;
  for (const CharacterizationBench& bench : report.characterization) out.push_back(section_of(bench));
  if (!report.characterization.empty()) out.push_back(legend_section(report.characterization.front()));
  if (report.fusion) out.push_back(over_all(*report.fusion));
  if (report.scaling)
    for (const char* over : {"samples", "threads", "sensors", "inputs"})
      out.push_back(growth_section(*report.scaling, over));
  if (report.design) {
    if (!report.design->sensors.empty()) out.push_back(sensors_section(*report.design));
    out.push_back(records_section(*report.design));
  }
  if (report.stress) {
    out.push_back(stress_section(*report.stress));
    out.push_back(worst_stress_section(*report.stress));
  }
  out.push_back(machine_section(report));
  return out;
}

}  // namespace libchar
