#include "libchar/report/compare/bench_against.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/benchmark/bench_view.hpp"
#include "libchar/core/document/fields.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/report/detail/json_pieces.hpp"

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
      const std::string who =
          "noise coefficients, " + bench.signal.name + ": " + method.name + ", ";
      for (const TermAccuracy& term : method.terms)
        add(out,
            fmt::format("{}RMSE of {}", who, kTermNames[static_cast<std::size_t>(term.term)].key),
            false,
            term.error);
      add(out, who + "ns a sample", true, method.ns_per_sample);
    }
  for (const FusionBenchRow& method :
       report.fusion ? report.fusion->rows : std::vector<FusionBenchRow>{}) {
    const std::string who = "fusion: " + method.label + ", ";
    Figure excess = method.excess;
    // As a ratio: an excess of zero has none.
    excess.value += 1, excess.ci95.low += 1, excess.ci95.high += 1;
    add(out, who + "RMSE over yardstick", false, excess);
    add(out, who + "ns an instant", true, method.ns_per_sample);
  }
  for (const ScalingSeries& series :
       report.scaling ? report.scaling->series : std::vector<ScalingSeries>{})
    if (!series.points.empty())
      add(out,
          fmt::format(
              "growth over {}: {}, at {}", series.over, series.name, series.points.back().x),
          true,
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
      out.add({c.what,
               figure_text(c.was),
               figure_text(c.now),
               fmt::format("{:.3f}", c.ratio),
               state_of(c)});
  return out;
}

}  // namespace

std::vector<BenchChange> BenchChanges::worse(double tolerance) const {
  std::vector<BenchChange> out;
  for (const BenchChange& c : figures)
    if (c.resolved && c.ratio > 1 + (c.is_time ? kTimeTolerance : 1) * tolerance &&
        (same_machine || !c.is_time))
      out.push_back(c);
  return out;
}

BenchChanges bench_changes(const BenchReport& was,
                           const BenchReport& now,
                           const std::string& file) {
  BenchChanges out;
  out.same_machine =
      was.machine.processor == now.machine.processor && was.machine.cores == now.machine.cores;
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
    throw input_error("E0968", file)
        .says("no figure of this run stands in it")
        .hint("run the same files and parts");
  return out;
}

std::string changes_text(const BenchChanges& changes, double tolerance) {
  const Table table = changes_table(changes);
  std::string out = table.rows.empty() ? table.title + "\n" : terminal_table(table);
  out += fmt::format("  {} of {} figures: no difference resolved\n",
                     changes.figures.size() - table.rows.size(),
                     changes.figures.size());
  if (!changes.missing.empty())
    out += fmt::format("  {} figures stand in the older run only\n", changes.missing.size());
  if (!changes.same_machine) out += "  another machine: times are shown and judge nothing\n";
  return out + fmt::format("  worse by more than {} %: {}\n\n",
                           100 * tolerance,
                           changes.worse(tolerance).size());
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

}  // namespace libchar
