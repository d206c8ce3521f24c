#include "libchar/report/compare/fleet_comparison_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/table/table.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {
namespace {

Json side_json(const LotCounts& counts, const LotFigures& f) {
  return {{"members", counts.members},
          {"counted", counts.counted},
          {"mean", json_number(f.mean)},
          {"mean_ci95", interval_json(f.mean_ci95)},
          {"spread", json_number(f.spread)},
          {"spread_ci95", interval_json(f.spread_ci95)}};
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
  const auto shown = [&](double value) {
    return number_text(logarithm ? 100 * (value - 1) : value, 3);
  };
  return fmt::format("{} [{}, {}]{}",
                     shown(d.change),
                     shown(d.change_ci95.low),
                     shown(d.change_ci95.high),
                     logarithm ? " %" : " " + d.unit);
}

Table differences_table(const FleetComparison& c) {
  Table out("channel|what|mean of |mean of |change|counted|differs");
  out.columns[2].head += c.name_a;
  out.columns[3].head += c.name_b;
  for (const LotDifference& d : c.differences)
    out.add({d.type.empty() ? d.group : d.group + " of " + d.type,
             title_of(d.quantity),
             number_text(d.a.mean) + " " + d.unit,
             number_text(d.b.mean) + " " + d.unit,
             changed(d),
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
      "In brackets the 95 % interval of that change alone. Of {} some leave out zero by chance: "
      "what differs is told by all of them together (Holm).",
      plural(c.tests, "test"));
}

}  // namespace

Json fleet_comparison_json(const FleetComparison& c,
                           const std::vector<std::string>& command,
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
  out["differences"] = Json::array();
  for (const LotDifference& d : c.differences) out["differences"].push_back(difference_json(d));
  out["not_compared"] = Json::array();
  for (const std::string& sentence : c.not_compared)
    out["not_compared"].push_back(json_text(sentence));
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
