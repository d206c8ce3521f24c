#include "libchar/report/compare/bench_against.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/benchmark/bench_view.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {
namespace {

struct Named {
  std::string what;
  bool is_time = false;
  Figure figure;
};

double number_of(const Json& value, double otherwise) {
  return value.is_number() ? value.get<double>() : otherwise;
}

const Json& at(const Json& object, const char* key) {
  static const Json kNothing;
  return object.is_object() && object.contains(key) ? object[key] : kNothing;
}

Figure figure_of(const Json& json) {
  Figure out;
  out.value = number_of(at(json, "value"), NAN);
  out.count = static_cast<std::size_t>(number_of(at(json, "count"), 0));
  const Json& ci = at(json, "ci95");
  if (ci.is_array() && ci.size() == 2)
    out.ci95 = {number_of(ci[0], -INFINITY), number_of(ci[1], INFINITY)};
  return out;
}

std::string word(const Json& object, const char* key) {
  const Json& value = at(object, key);
  return value.is_string() ? value.get<std::string>() : "";
}

void add(std::vector<Named>& out, const std::string& what, bool is_time, const Figure& figure) {
  if (figure.count > 0 && !std::isnan(figure.value)) out.push_back({what, is_time, figure});
}

std::vector<Named> figures_in(const Json& document) {
  std::vector<Named> out;
  for (const Json& bench : at(document, "characterization"))
    for (const Json& method : at(bench, "methods")) {
      const std::string who =
          "noise coefficients, " + word(bench, "signal") + ": " + word(method, "name") + ", ";
      for (const Json& term : at(method, "terms"))
        add(out,
            who + "RMSE of " + word(term, "term"),
            false,
            figure_of(at(term, "rmse_over_bound")));
      add(out, who + "ns a sample", true, figure_of(at(method, "ns_per_sample")));
    }
  for (const Json& method : at(at(document, "fusion"), "methods")) {
    const std::string who = "fusion: " + word(method, "label") + ", ";
    Figure excess = figure_of(at(method, "excess"));
    // As a ratio: an excess of zero has none.
    excess.value += 1, excess.ci95.low += 1, excess.ci95.high += 1;
    add(out, who + "RMSE over yardstick", false, excess);
    add(out, who + "ns an instant", true, figure_of(at(method, "ns_per_instant")));
  }
  for (const Json& series : at(at(document, "scaling"), "series"))
    if (const Json& points = at(series, "points"); points.is_array() && !points.empty())
      add(out,
          fmt::format("growth over {}: {}, at {}",
                      word(series, "over"),
                      word(series, "name"),
                      number_of(at(points.back(), "x"), 0)),
          true,
          figure_of(at(points.back(), "cost")));
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

BenchChanges bench_changes(const Json& was, const Json& now, const std::string& file) {
  if (word(was, "format") != "bench")
    throw Error({ErrorKind::input,
                 "E0968",
                 file,
                 "no document of benchmarks",
                 word(was, "format"),
                 "the bench.json of an earlier run"});
  BenchChanges out;
  const Json &older = at(was, "machine"), &newer = at(now, "machine");
  out.same_machine = at(older, "processor") == at(newer, "processor") &&
                     at(older, "processors") == at(newer, "processors");
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
    throw Error({ErrorKind::input,
                 "E0968",
                 file,
                 "no figure of this run stands in it",
                 "",
                 "run the same files and parts"});
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
  Json out = {{"same_machine", changes.same_machine},
              {"tolerance", json_number(tolerance)},
              {"worse", changes.worse(tolerance).size()},
              {"missing", Json::array()},
              {"figures", Json::array()}};
  for (const std::string& what : changes.missing) out["missing"].push_back(json_text(what));
  for (const BenchChange& c : changes.figures)
    out["figures"].push_back({{"what", json_text(c.what)},
                              {"time", c.is_time},
                              {"was", json_number(c.was.value)},
                              {"now", json_number(c.now.value)},
                              {"ratio", json_number(c.ratio)},
                              {"resolved", c.resolved}});
  return out;
}

}  // namespace libchar
