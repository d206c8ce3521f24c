#include "libchar/report/compare/comparison_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/table/table.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/report/detail/tables/replay_tables.hpp"

namespace libchar {
namespace {

template <const ReplayReport::Algorithm* ComparedAlgorithm::*Side>
void write_side(const Field& row, const ComparedAlgorithm& compared, std::vector<Entry>& out) {
  static const Fields<ReplayReport::Algorithm> rows =
      selected(ReplayReport::Algorithm::fields(),
               {"status", "why", "rmse", "rmse_ci95", "regret", "ns_per_sample", "peak_bytes"}, Written::always);
  const ReplayReport::Algorithm* const one = compared.*Side;
  out.push_back(one == nullptr ? Entry{std::string(row.key)}
                               : part_entry(std::string(row.key), entries_of(rows, *one)));
}

const Fields<ComparedAlgorithm> kComparedFields = always(Fields<ComparedAlgorithm>{
    field<&ComparedAlgorithm::label>("label"),
    written<ComparedAlgorithm, write_side<&ComparedAlgorithm::a>>("a", ""),
    written<ComparedAlgorithm, write_side<&ComparedAlgorithm::b>>("b", ""),
    field<&ComparedAlgorithm::difference>("difference"),
    field<&ComparedAlgorithm::rmse_change>("rmse_change"),
    field<&ComparedAlgorithm::ns_change>("ns_per_sample_change"),
    field<&ComparedAlgorithm::bytes_change>("peak_bytes_change"),
});

const Fields<ReplayReport> kSideFields = always(Fields<ReplayReport>{
    field<&ReplayReport::file>("file"),
    field_or_null<&ReplayReport::head, &DocumentHead::program>("program"),
    computed<[](const ReplayReport& report) { return report.scene_title(); }>("scene"),
    field_or_null<&ReplayReport::best>("best"),
});

/// What is compared of a method: NaN where it did not run.
struct Scores {
  double rmse = kNone, ns_per_sample = kNone, peak_bytes = kNone;
};
Scores scores_of(const ReplayReport::Algorithm* one) {
  if (one == nullptr || !one->ran) return {};
  return {one->rmse, one->ns_per_sample, one->peak_bytes ? static_cast<double>(*one->peak_bytes) : kNone};
}

/// "+4.62 %", "0 %"; "–" for no number.
std::string change_text(double change) {
  if (!std::isfinite(change)) return "–";
  if (change == 0) return "0 %";
  const double percent = 100 * change;
  return std::abs(percent) < 0.005 ? (percent > 0 ? "+0.00 %" : "-0.00 %") : fmt::format("{:+.2f} %", percent);
}

}  // namespace

std::string side_of(const ComparedAlgorithm& row) {
  if (row.both_ran()) return "";
  if (row.a == nullptr) return row.b->ran ? "only in B" : "only in B, skipped";
  if (row.b == nullptr) return row.a->ran ? "only in A" : "only in A, skipped";
  return row.a->ran ? "skipped in B" : row.b->ran ? "skipped in A" : "skipped in both";
}

namespace {

Table compared_table(const Comparison& c) {
  const std::string score = c.a.reference ? "RMSE" : "leave-one-out RMS";
  Table out("algorithm|" + score + " A|" + score + " B|change|a sample A|B|change|memory A|B|error of B");
  for (const ComparedAlgorithm& row : c.algorithms) {
    if (row.a != nullptr && row.b != nullptr && !row.a->ran && !row.b->ran) continue;
    const std::string where = side_of(row);
    const Scores a = scores_of(row.a), b = scores_of(row.b);
    out.add({row.label, brief_text(a.rmse, 5), brief_text(b.rmse, 5), change_text(row.rmse_change),
             time_cell(a.ns_per_sample), time_cell(b.ns_per_sample), change_text(row.ns_change),
             memory_cell(a.peak_bytes), memory_cell(b.peak_bytes),
             where.empty() ? std::string(name_of(row.difference)) : where});
  }
  return out;
}

}  // namespace

const Fields<Comparison>& comparison_fields() {
  using T = Comparison;
  static const Fields<T> rows = always(Fields<T>{
      part<&T::a>("a", kSideFields),
      part<&T::b>("b", kSideFields),
      field<&T::verdict>("verdict"),
      computed<[](const T& c) { return c.a.reference ? "rmse" : "predictive_rms"; }>("score"),
      field<&T::unlike>("unlike"),
      field<&T::remarks>("remarks"),
      list_of<&T::algorithms>("algorithms", kComparedFields),
  });
  return rows;
}

Json comparison_json(const Comparison& comparison) { return document_of(comparison_fields(), comparison); }

std::string comparison_text(const Comparison& c, std::size_t width) {
  std::string out = fmt::format("A: {}: {}\nB: {}: {}\n", printable(c.a.file), printable(c.a.scene_title()),
                                printable(c.b.file), printable(c.b.scene_title()));
  for (const std::string& sentence : c.unlike) out += "unlike: " + printable(sentence) + "\n";
  for (const std::string& sentence : c.remarks) out += "differs: " + printable(sentence) + "\n";
  return out + "\n" + terminal_table(compared_table(c), {width}, "") + "\n" + printable(c.verdict) + "\n";
}

std::string comparison_markdown(const Comparison& c) {
  std::string out =
      fmt::format("# {}\n\n{}\n\nA: {}, program {}. B: {}, program {}.\n", markdown_text(c.a.scene_title()),
                  markdown_text(c.verdict), markdown_text(c.a.file), markdown_text(c.a.head.program),
                  markdown_text(c.b.file), markdown_text(c.b.head.program));
  const char* heads[] = {"These are not two replays of one scene:", "What else differs:"};
  const std::vector<std::string>* lists[] = {&c.unlike, &c.remarks};
  for (std::size_t i = 0; i < 2; ++i) {
    if (lists[i]->empty()) continue;
    out += fmt::format("\n{}\n\n", heads[i]);
    for (const std::string& sentence : *lists[i]) out += fmt::format("- {}\n", markdown_text(sentence));
  }
  return out + "\n" + table_text(compared_table(c)) + "\nResolved: the 95 % intervals of the two do not overlap.\n";
}

namespace {

Json side_json(const LotCounts& counts, const LotFigures& f) {
  return {{"members", counts.members},       {"counted", counts.counted},
          {"mean", json_number(f.mean)},     {"mean_ci95", interval_json(f.mean_ci95)},
          {"spread", json_number(f.spread)}, {"spread_ci95", interval_json(f.spread_ci95)}};
}

Json difference_json(const LotDifference& d) {
  return {{"type", json_text(d.type)},
          {"channel", json_text(d.group)},
          {"what", std::string(name_of(d.quantity))},
          {"unit", json_text(d.unit)},
          {"a", side_json(d.counts_a, d.a)},
          {"b", side_json(d.counts_b, d.b)},
          {"change_is", in_logarithm(d.quantity) ? "ratio" : "difference"},
          {"change", json_number(d.change)},
          {"change_ci95", interval_json(d.change_ci95)},
          {"p_mean", json_number(d.p_mean)},
          {"p_mean_of_all", json_number(d.p_mean_of_all)},
          {"p_spread", json_number(d.p_spread)},
          {"p_spread_of_all", json_number(d.p_spread_of_all)},
          {"mean_differs", d.mean_differs},
          {"spread_differs", d.spread_differs},
          {"sentence", json_text(d.sentence)}};
}

std::string changed(const LotDifference& d) {
  const bool logarithm = in_logarithm(d.quantity);
  const auto shown = [&](double value) { return number_text(logarithm ? 100 * (value - 1) : value, 3); };
  return fmt::format("{} [{}, {}]{}", shown(d.change), shown(d.change_ci95.low), shown(d.change_ci95.high),
                     logarithm ? " %" : " " + d.unit);
}

Table differences_table(const FleetComparison& c) {
  Table out("channel|what|mean of |mean of |change|counted|differs");
  out.columns[2].head += c.name_a;
  out.columns[3].head += c.name_b;
  for (const LotDifference& d : c.differences)
    out.add({d.type.empty() ? d.group : d.group + " of " + d.type, title_of(d.quantity),
             number_text(d.a.mean) + " " + d.unit, number_text(d.b.mean) + " " + d.unit, changed(d),
             fmt::format("{} and {}", d.counts_a.counted, d.counts_b.counted),
             d.mean_differs && d.spread_differs ? "mean and spread"
             : d.mean_differs                   ? "mean"
             : d.spread_differs                 ? "spread"
                                                : ""});
  return out;
}

/// Why a change whose interval leaves zero out need not differ.
std::string corrected_note(const FleetComparison& c) {
  return fmt::format(
      "In brackets: 95 % interval of each change alone. Some of {} exclude zero by chance; significance is decided "
      "over all of them together (Holm).",
      plural(c.tests, "test"));
}

}  // namespace

Json fleet_comparison_json(const FleetComparison& c, const std::vector<std::string>& command,
                           const std::vector<LogInfo>& inputs) {
  std::vector<const LogInfo*> files;
  files.reserve(inputs.size());
  for (const LogInfo& one : inputs) files.push_back(&one);
  Json out = document_head("fleet-comparison", command, files);
  out["a"] = {{"name", json_text(c.name_a)}, {"devices", c.devices_a}};
  out["b"] = {{"name", json_text(c.name_b)}, {"devices", c.devices_b}};
  out["verdict"] = json_text(c.verdict);
  out["tests"] = c.tests;
  out["false_alarm"] = c.false_alarm;
  out["differences"] = list_json(c.differences, difference_json);
  out["not_compared"] = texts_json(c.not_compared);
  out["notes"] = texts_json(c.notes);
  return out;
}

std::string fleet_comparison_text(const FleetComparison& c, std::size_t width) {
  std::string out = printable(c.verdict) + "\n";
  for (const LotDifference& d : c.differences)
    if (d.mean_differs || d.spread_differs) out += "  " + printable(d.sentence) + "\n";
  if (!c.differences.empty())
    out += "\n" + terminal_table(differences_table(c), {width}) + "  " + corrected_note(c) + "\n";
  if (!c.not_compared.empty() || !c.notes.empty()) out += "\n";
  for (const std::string& sentence : c.notes) out += "  " + printable(sentence) + "\n";
  for (const std::string& sentence : c.not_compared) out += "  " + printable(sentence) + "\n";
  return out;
}

}  // namespace libchar
