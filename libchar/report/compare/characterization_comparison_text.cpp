#include "libchar/report/compare/characterization_comparison_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/core/table/table.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {
namespace {

Json summary_json(const ReportedCharacterization& s) {
  return {{"file", json_text(s.file)},
          {"format", s.format},
          {"program", s.program.empty() ? Json(nullptr) : Json(json_text(s.program))},
          {"recording", json_text(s.recording)}};
}

Json side_json(const Coefficient& c) {
  return {{"value", json_number(c.value)},
          {"ci95", c.value ? interval_json(c.ci95) : Json(nullptr)},
          {"upper95", json_number(c.upper95)},
          {"status", name_of(c.status)}};
}

Json compared_json(const ComparedTerm& t, const std::string& unit) {
  const auto key = kTermNames[static_cast<std::size_t>(t.term)].key;
  return {{"term", key},
          {"unit", json_text(term_unit(key, unit))},
          {"a", side_json(t.a)},
          {"b", side_json(t.b)},
          {"ratio", json_number(t.ratio)},
          {"ratio_ci95", t.ratio ? interval_json(t.ratio_ci95) : Json(nullptr)},
          {"p", json_number(t.p)},
          {"difference", name_of(t.difference)},
          {"sentence", json_text(t.sentence)}};
}

std::string where_is(const ComparedChannel& c) {
  return c.in_a ? c.in_b ? "" : "only in A" : "only in B";
}

Table compared_table(const CharacterizationComparison& comparison) {
  Table out("channel|term|A|B|unit|");
  for (const ComparedChannel& c : comparison.channels) {
    if (!where_is(c).empty()) out.add({c.name, "", "", "", "", where_is(c)});
    for (const ComparedTerm& t : c.terms) {
      const auto key = kTermNames[static_cast<std::size_t>(t.term)].key;
      out.add({c.name,
               key,
               coefficient_text(t.a),
               coefficient_text(t.b),
               term_unit(key, c.unit),
               t.sentence});
    }
    for (const std::string& remark : c.remarks) out.add({c.name, "", "", "", "", remark});
  }
  return out;
}

}  // namespace

Json comparison_json(const CharacterizationComparison& comparison) {
  Json out = {{"a", summary_json(comparison.a)},
              {"b", summary_json(comparison.b)},
              {"verdict", json_text(comparison.verdict)}};
  out["channels"] = Json::array();
  for (const ComparedChannel& c : comparison.channels) {
    Json channel = {{"name", json_text(c.name)},
                    {"unit", json_text(c.unit)},
                    {"in_a", c.in_a},
                    {"in_b", c.in_b}};
    channel["terms"] = Json::array();
    for (const ComparedTerm& t : c.terms) channel["terms"].push_back(compared_json(t, c.unit));
    channel["remarks"] = Json::array();
    for (const std::string& remark : c.remarks) channel["remarks"].push_back(json_text(remark));
    out["channels"].push_back(std::move(channel));
  }
  return out;
}

std::string comparison_text(const CharacterizationComparison& comparison, std::size_t width) {
  std::string out = fmt::format("A: {} ({})\nB: {} ({})\n",
                                printable(comparison.a.file),
                                printable(comparison.a.recording),
                                printable(comparison.b.file),
                                printable(comparison.b.recording));
  return out + "\n" + terminal_table(compared_table(comparison), {width}, "") + "\n" +
         printable(comparison.verdict) + "\n";
}

std::string comparison_markdown(const CharacterizationComparison& comparison) {
  return "# Two characterizations\n\n" + markdown_text(comparison.verdict) +
         "\n\n- A: " + markdown_text(comparison.a.file) +
         "\n- B: " + markdown_text(comparison.b.file) + "\n\n" +
         table_text(compared_table(comparison));
}

}  // namespace libchar
