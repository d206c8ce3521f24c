#include "libchar/report/detail/tables/replay_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/units.hpp"
#include "libchar/replay/view/words.hpp"

namespace libchar {
namespace {

/// A point in time, in seconds without trailing zeros: "400 s".
std::string instant_text(double seconds) { return std::isfinite(seconds) ? brief_text(seconds, 8) + " s" : "–"; }

std::vector<Cell::Mark> marks_of(const AlgorithmView& v) {
  const AlgorithmResult& a = *v.result;
  std::vector<Cell::Mark> out;
  if (v.best) out.push_back({"best", Tint::good});
  if (a.bound) out.push_back({"bound", {}});
  if (!a.bound && !v.best && a.as_good_as_best) out.push_back({"not resolved from the best", Tint::doubtful});
  if (!a.bound && v.learns) out.push_back({"learns from a reference", {}});
  if (v.on_time_front && v.on_memory_front)
    out.push_back({"fronts: time, memory", {}});
  else if (v.on_time_front || v.on_memory_front)
    out.push_back({v.on_time_front ? "front: time" : "front: memory", {}});
  return out;
}

Cell name_cell(const AlgorithmView& v) {
  Cell out(v.result->label);
  out.sign = v.result->bound ? "(bound)" : v.result->as_good_as_best ? "*" : "";
  out.marks = marks_of(v);
  if (v.result->description != nullptr) out.notes.emplace_back(v.result->description->title);
  if (!v.settings.empty()) out.notes.push_back(v.settings);
  return out;
}

const ErrorScore& score_of(const AlgorithmResult& a) {
  static const ErrorScore none = [] {
    ErrorScore e;
    e.rmse = e.bias = e.maximum = e.converged_s = kNone;
    e.bias_ci95 = {kNone, kNone};
    return e;
  }();
  return a.inputs.empty() ? none : a.inputs[0].error;
}

/// Sorted by its size.
Cell bias_cell(const ErrorScore& e) {
  Cell out = Cell::number(e.bias, e.bias_ci95, 3);
  out.value = std::fabs(e.bias);
  return out;
}

Cell ratio_cell(const AlgorithmResult& a) {
  if (!a.ratio_to_best || !std::isfinite(a.ratio_to_best->low)) return Cell::shown("–", kNone);
  return Cell::shown(interval_text(*a.ratio_to_best), a.ratio_to_best->low);
}

Cell duration_cell(double seconds) { return Cell::shown(duration_text(seconds), seconds); }

Cell share_cell(double share) { return Cell::shown(percent_text(share, 4), share); }

// The scores, then what each costs; what seldom decides is folded at first.
Table algorithm_columns(const ReplayView& view) {
  const bool reference = view.result->has_reference;
  Table out(reference
                ? "algorithm||regret|× best method|bias|maximum|converged|available|time per sample|memory|learning"
                : "algorithm||× best method|split-array RMS|available|time per sample|memory|learning");
  out.columns[1] = score_column(reference, score_unit(*view.result));
  for (Table::Column& column : out.columns) {
    const auto is = [&](const auto&... heads) { return ((column.head == heads) || ...); };
    if (is("× best method", "converged", "learning")) column.doors = Table::kPage;
    if (is("bias", "maximum", "split-array RMS", "available")) column.doors = Table::kDocument | Table::kPage;
    column.folded = (is("bias") && !view.figures.bias) || is("maximum", "converged", "memory", "learning") ||
                    (is("available") && !view.figures.availability) ||
                    (is("time per sample") && !view.figures.time_matters);
  }
  return out;
}

void add_algorithm(Table& table, const AlgorithmView& v, bool has_reference) {
  const AlgorithmResult& a = *v.result;
  const ErrorScore& e = score_of(a);
  std::vector<Cell> cells = {name_cell(v), Cell::number(a.rmse, a.rmse_ci95)};
  if (has_reference) cells.push_back(regret_cell(a.regret));
  cells.push_back(ratio_cell(a));
  if (has_reference) {
    cells.push_back(bias_cell(e));
    cells.push_back(Cell::number(e.maximum, 3));
    cells.push_back(duration_cell(e.converged_s));
  } else {
    cells.push_back(Cell::number(a.blind ? a.blind->split_rms : kNone));
  }
  cells.push_back(share_cell(a.availability));
  cells.push_back(time_cell(a.ns_per_sample));
  cells.push_back(memory_cell(a.peak_bytes ? static_cast<double>(*a.peak_bytes) : kNone));
  cells.push_back(duration_cell(a.learning_s));
  table.add(std::move(cells), v.best ? Table::Kind::best : a.bound ? Table::Kind::aside : Table::Kind::plain);
}

}  // namespace

Table algorithms_table(const ReplayView& view) {
  Table out = algorithm_columns(view);
  const bool reference = view.result->has_reference;
  for (const AlgorithmView* v : view.ranked)
    if (!v->result->bound) add_algorithm(out, *v, reference);
  const std::size_t methods = out.rows.size();
  for (const AlgorithmView* v : view.ranked)
    if (v->result->bound) add_algorithm(out, *v, reference);
  if (out.rows.size() == methods) return out;
  // Their own body, so that sorting keeps them apart from what one could use.
  out.rows.insert(
      out.rows.begin() + static_cast<std::ptrdiff_t>(methods),
      Table::Row{{"Bounds: they use the reference of the run itself and cannot be deployed"}, Table::Kind::part});
  return out;
}

Table needs_table(const ReplayView& view) {
  Table out("algorithm|what it is|needs|a step costs|a learning instant costs|source|here");
  for (const AlgorithmView& v : view.algorithms) {
    const AlgorithmResult& a = *v.result;
    if (a.description == nullptr) continue;
    out.add({a.label, a.description->title,
             v.needs.empty() ? "nothing but the samples" : fmt::format("{}", fmt::join(v.needs, "; ")),
             a.description->complexity, a.description->learning_complexity, a.description->source,
             a.ran ? "ran" : "skipped: " + a.why});
  }
  return out;
}

namespace {

Table input_table(const ReplayView& view, std::size_t j) {
  const InputResult& input = *view.inputs[j].result;
  Table out("algorithm||regret|bias|maximum|converged|available");
  out.title = "Input " + input.name;
  out.note =
      "Optimum of " + view.optimum + ": RMSE " + with_unit(input.optimum_rmse, 4, detail::usual_unit(input.unit));
  out.columns[1] = score_column(true, input.unit);
  for (const AlgorithmView* v : view.inputs[j].ranked) {
    const AlgorithmResult& a = *v->result;
    const ErrorScore& e = a.inputs[j].error;
    out.add({a.label, Cell::number(e.rmse, e.rmse_ci95), regret_cell(a.inputs[j].optimum_ratio - 1), bias_cell(e),
             Cell::number(e.maximum, 3), duration_cell(e.converged_s), share_cell(e.availability)},
            v->best   ? Table::Kind::best
            : a.bound ? Table::Kind::aside
                      : Table::Kind::plain);
  }
  return out;
}

void add_sensors(Table& table, const ReplayResult& r) {
  for (const SensorResult& s : r.sensors) table.columns.push_back({.head = s.name, .name = true});
}

void add_watching(Table& table, const ReplayView& view) {
  for (const AlgorithmView* a : view.watching) table.columns.push_back({.head = a->result->label, .name = true});
}

}  // namespace

std::vector<Table> input_tables(const ReplayView& view) {
  std::vector<Table> out;
  if (view.inputs.size() < 2 || !view.result->has_reference) return out;
  for (std::size_t j = 0; j < view.inputs.size(); ++j) out.push_back(input_table(view, j));
  return out;
}

Table sensors_table(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  Table out("sensor|RMSE|bias|maximum|unit|noise of a sample|from|offset taken off|missing|row of H|");
  for (std::size_t i = 0; i < r.sensors.size(); ++i) {
    const SensorResult& s = r.sensors[i];
    std::string h;
    for (const double v : s.h) h += (h.empty() ? "" : ", ") + brief_text(v, 4);
    const auto scored = [&](Cell cell) { return r.has_reference ? std::move(cell) : Cell(); };
    out.add({s.name, scored(Cell::number(s.error.rmse, s.error.rmse_ci95)), scored(Cell::number(s.error.bias, 3)),
             scored(Cell::number(s.error.maximum, 3)), detail::usual_unit(s.unit),
             view.noise_sd[i] ? Cell::number(*view.noise_sd[i]) : Cell("not known"), s.noise_source,
             s.offset == 0 ? Cell() : Cell::number(s.offset),
             Cell::shown(s.missing > 0 ? percent_text(s.missing) : "none", s.missing), r.scene.tilt ? "" : h,
             s.constant           ? "never changed"
             : !s.copy_of.empty() ? "the same as " + s.copy_of
                                  : ""});
  }
  return out;
}

Table blind_table(const ReplayView& view) {
  Table out("leave-one-out RMS of");
  out.title = "Each sensor against the others";
  add_sensors(out, *view.result);
  if (view.result->has_reference) return out;
  for (const AlgorithmView* one : view.ranked) {
    if (!one->result->blind) continue;
    std::vector<Cell> row = {one->result->label};
    for (const double v : one->result->blind->leave_one_out) row.push_back(Cell::number(v));
    row.resize(out.columns.size(), "–");
    out.add(std::move(row));
  }
  return out;
}

Table weights_table(const ReplayView& view) {
  Table out("median over the run");
  add_sensors(out, *view.result);
  const bool far = std::any_of(view.final_rows.begin(), view.final_rows.end(),
                               [](const FinalRow& final) { return std::isfinite(final.distance); });
  if (far) out.columns.push_back({"distance"});
  if (far)
    out.note =
        "Distance: of weights, root mean square over the run of their Euclidean distance from the optimal fixed "
        "weights; "
        "of standard deviations, root mean square of ln(variance / the sensor's mean square error).";
  for (const FinalRow& final : view.final_rows) {
    std::vector<Cell> row = {final.label};
    for (const double value : final.values) row.push_back(Cell::number(value));
    row.resize(out.columns.size() - (far ? 1 : 0), "–");
    if (far) row.push_back(Cell::number(final.distance, 3));
    out.add(std::move(row));
  }
  return out;
}

namespace {

std::string answer_in_words(const FaultAnswer* answer) {
  if (answer == nullptr) return "–";
  if (!answer->found_s) return "missed";
  return (*answer->found_s == 0 ? "found at once" : "found after " + duration_text(*answer->found_s)) +
         (answer->returned_s ? ", used again " + duration_text(*answer->returned_s) + " after its end" : "");
}

void add_alarms(Table& table, const ReplayView& view) {
  std::vector<Cell> row = {"alarms where no fault is known", "", "", ""};
  for (const AlgorithmView* a : view.watching)
    row.emplace_back(
        count_text(a->alarms_without_fault) +
        (a->result->faults_not_kept > 0 ? " (" + count_text(a->result->faults_not_kept) + " events not kept)" : ""));
  if (!view.watching.empty()) table.add(std::move(row));
}

}  // namespace

Table faults_table(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  Table out("known fault|sensor|from|to");
  add_watching(out, view);
  add_alarms(out, view);
  for (std::size_t f = 0; f < r.faults.size(); ++f) {
    const SensorFault& fault = r.faults[f];
    const bool valueless = fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout;
    std::vector<Cell> row = {std::string(name_of(fault.kind)) + (valueless ? "" : " " + brief_text(fault.value, 4)),
                             fault.sensor < r.sensors.size() ? r.sensors[fault.sensor].name : "–",
                             instant_text(fault.from_s),
                             std::isfinite(fault.to_s) ? instant_text(fault.to_s) : "the end"};
    for (const AlgorithmView* a : view.watching) row.emplace_back(answer_in_words(a->answers[f]));
    out.add(std::move(row));
  }
  return out;
}

Table detection_table(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  Table out("one false alarm in");
  if (!view.figures.detection) return out;
  for (const FaultAnswer& answer : r.detection[0].answers) {
    const SensorFault& fault = r.faults[detail::in_memory(answer.fault)];
    out.columns.push_back({fmt::format("{} {} from {}: found after", r.sensors[fault.sensor].name, name_of(fault.kind),
                                       instant_text(fault.from_s))});
  }
  out.columns.push_back({"alarms where no fault is known"});
  for (const DetectionAt& at : r.detection) {
    std::vector<Cell> row = {duration_text(at.false_alarm_s)};
    for (const FaultAnswer& answer : at.answers)
      row.emplace_back(answer.found_s ? duration_text(*answer.found_s) : "never");
    row.emplace_back(count_text(at.alarms_without_fault));
    out.add(std::move(row));
  }
  return out;
}

// Sensors that were never out need no row.
Table out_share_table(const ReplayView& view) {
  const std::vector<SensorResult>& sensors = view.result->sensors;
  Table out("share of the run out");
  add_watching(out, view);
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    std::vector<Cell> row = {sensors[i].name};
    bool ever = false;
    for (const AlgorithmView* a : view.watching) {
      const double share = i < a->out_share.size() ? a->out_share[i] : 0;
      ever = ever || share > 0;
      row.emplace_back(share > 0 ? percent_text(share) : "never");
    }
    if (ever) out.add(std::move(row));
  }
  return out;
}

Table::Column score_column(bool has_reference, const std::string& unit) {
  const std::string name = has_reference ? "RMSE" : "leave-one-out RMS";
  const std::string usual = detail::usual_unit(unit);
  return {usual.empty() ? name : name + ", " + usual, "rmse,low95,high95"};
}

Cell regret_cell(double regret) { return Cell::shown(excess_text(regret), regret); }

Cell time_cell(double nanoseconds) { return Cell::shown(duration_text(1e-9 * nanoseconds), nanoseconds); }

Cell memory_cell(double bytes) {
  const auto whole = std::isfinite(bytes) ? std::optional(static_cast<std::uint64_t>(bytes)) : std::nullopt;
  return Cell::shown(bytes_text(whole), bytes);
}

std::string score_name(const ReplayResult& result) { return result.has_reference ? "RMSE" : "Leave-one-out RMS"; }

std::string score_unit(const ReplayResult& result) {
  return result.inputs.empty() ? "" : detail::usual_unit(result.inputs[0].unit);
}

std::string with_unit(double value, int digits, const std::string& unit) {
  const std::string number = number_text(value, digits);
  return unit.empty() || !std::isfinite(value) ? number : number + " " + unit;
}

std::string stretch_text(double from_s, double to_s) {
  return instant_text(from_s) + " … " + (std::isfinite(to_s) ? instant_text(to_s) : "the end");
}

std::vector<std::string> run_facts(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::vector<std::string> out = {fmt::format("{} sensors, {} instants at {}, {} from {} on.", r.sensors.size(),
                                              r.instants, detail::frequency_text(r.rate_hz, 6),
                                              duration_text(view.duration_s), instant_text(r.start_s))};
  out.push_back(r.has_reference ? "Reference: " + r.reference_use + "." : "No reference.");
  for (const InputResult& input : r.inputs)
    if (r.has_reference && std::isfinite(input.optimum_rmse))
      out.push_back(fmt::format("Optimum of {}{}: RMSE {}.", view.optimum,
                                r.inputs.size() > 1 ? " for " + input.name : "",
                                with_unit(input.optimum_rmse, 4, detail::usual_unit(input.unit))));
  if (r.lag_estimated)
    out.push_back(fmt::format("The sensors lag the reference by {} (estimated).", duration_text(r.lag_s)));
  for (std::string& sentence : preparation_words(r)) out.push_back(std::move(sentence));
  return out;
}

std::vector<std::string> skipped_words(const ReplayView& view) {
  std::vector<std::string> out;
  for (const SkippedAlgorithms& s : view.skipped)
    out.push_back(fmt::format("{}: {}", fmt::join(s.labels, ", "), s.reason));
  return out;
}

std::vector<std::string> remark_words(const ReplayView& view) {
  std::vector<std::string> out;
  for (const AlgorithmRemark& remark : view.remarks)
    out.push_back(remark.label + ": " + remark.message +
                  (remark.count > 1 ? fmt::format(" ({} ×)", remark.count) : ""));
  return out;
}

}  // namespace libchar
