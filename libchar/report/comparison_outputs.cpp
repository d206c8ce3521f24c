// A comparison as a table, a JSON document and Markdown.

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text.hpp"
#include "libchar/core/version.hpp"
#include "libchar/report/comparison.hpp"
#include "libchar/report/escape.hpp"
#include "libchar/report/people.hpp"
#include "libchar/report/replay_markdown.hpp"
#include "libchar/report/replay_verdict.hpp"
#include "libchar/report/replay_words.hpp"

namespace libchar {
namespace {

std::string cell(const std::optional<double>& value, int digits = 4) {
  return value ? people(*value, digits) : "–";
}

std::string change(const std::optional<double>& share) {
  if (!share) return "–";
  const double percent = 100 * *share;
  return percent == 0               ? "0 %"
         : std::fabs(percent) < 100 ? fmt::format("{:+.2f} %", percent)
                                    : fmt::format("{:+.0f} %", percent);
}

std::string bytes(const std::optional<double>& value) {
  return value && *value >= 0 ? people_bytes(static_cast<std::uint64_t>(*value)) : "–";
}

Json side(const ReportedAlgorithm& a) {
  return {{"score", json_number(a.score)},
          {"score_ci95",
           a.score_ci95 ? Json::array({a.score_ci95->low, a.score_ci95->high}) : Json(nullptr)},
          {"regret", json_number(a.regret)},
          {"ns_per_sample", json_number(a.ns_per_sample)},
          {"peak_bytes", json_number(a.peak_bytes)}};
}

Json only_json(const std::vector<std::pair<std::string, std::string>>& list) {
  Json out = Json::array();
  for (const auto& [label, why] : list)
    out.push_back({{"label", json_text(label)}, {"why", json_text(why)}});
  return out;
}

std::string score_title(const Comparison& c) {
  return c.a.score == "rmse" ? "RMSE" : "leave-one-out RMS";
}

std::string only_lines(const std::vector<std::pair<std::string, std::string>>& list,
                       const char* where) {
  std::string out;
  for (const auto& [label, why] : list)
    out += fmt::format("- {} ran in {} only{}\n",
                       markdown_text(label),
                       where,
                       why.empty() ? "" : ": " + markdown_text(why));
  return out;
}

}  // namespace

std::vector<std::vector<std::string>> comparison_table(const Comparison& c) {
  const std::string unit = usual_unit(c.a.unit);
  const std::string title = score_title(c) + (unit.empty() ? "" : ", " + unit);
  std::vector<std::vector<std::string>> rows = {{"algorithm",
                                                 title + " A",
                                                 "B",
                                                 "change",
                                                 "resolved",
                                                 "ns/sample A",
                                                 "B",
                                                 "change",
                                                 "memory A",
                                                 "B",
                                                 "change"}};
  for (const ComparedAlgorithm& row : c.both)
    rows.push_back({row.a.label + (row.a.bound ? " (bound)" : ""),
                    cell(row.a.score, 5),
                    cell(row.b.score, 5),
                    change(row.score_change),
                    !row.resolved   ? "–"
                    : *row.resolved ? "yes"
                                    : "no",
                    cell(row.a.ns_per_sample, 3),
                    cell(row.b.ns_per_sample, 3),
                    change(row.ns_change),
                    bytes(row.a.peak_bytes),
                    bytes(row.b.peak_bytes),
                    change(row.bytes_change)});
  return rows;
}

Json comparison_json(const Comparison& c, const std::vector<Check>& checks) {
  Json out = {{"format", "replay-comparison"}, {"version", 1}};
  out["tool"] = {{"name", "sensorchar"}, {"version", version()}};
  out["a"] = {{"path", json_text(c.a.file)}, {"scene", json_text(c.a.scene)}};
  out["b"] = {{"path", json_text(c.b.file)}, {"scene", json_text(c.b.scene)}};
  out["score"] = json_text(c.a.score);
  out["unit"] = json_text(c.a.unit);
  out["alike"] = c.differences.empty();
  out["differences"] = Json::array();
  for (const std::string& sentence : c.differences)
    out["differences"].push_back(json_text(sentence));
  out["algorithms"] = Json::array();
  for (const ComparedAlgorithm& row : c.both)
    out["algorithms"].push_back({{"label", json_text(row.a.label)},
                                 {"bound", row.a.bound},
                                 {"a", side(row.a)},
                                 {"b", side(row.b)},
                                 {"score_change", json_number(row.score_change)},
                                 {"regret_change", json_number(row.regret_change)},
                                 {"ns_change", json_number(row.ns_change)},
                                 {"bytes_change", json_number(row.bytes_change)},
                                 {"resolved", row.resolved ? Json(*row.resolved) : Json(nullptr)}});
  out["only_in_a"] = only_json(c.only_a);
  out["only_in_b"] = only_json(c.only_b);
  out["checks"] = Json::array();
  for (const Check& check : checks) {
    Json sentences = Json::array();
    for (const std::string& sentence : breaches(c, check)) sentences.push_back(json_text(sentence));
    out["checks"].push_back(
        {{"check", json_text(check.text)}, {"passed", sentences.empty()}, {"breaches", sentences}});
  }
  return out;
}

std::string comparison_markdown(const Comparison& c, const std::vector<Check>& checks) {
  std::string out = fmt::format("## {}: {} against {}\n\n",
                                markdown_text(c.a.scene),
                                markdown_text(c.a.file),
                                markdown_text(c.b.file));
  for (const std::string& sentence : c.differences)
    out += "**Unlike scenes:** " + markdown_text(sentence) + "\n\n";
  auto rows = comparison_table(c);
  for (auto& row : rows)
    for (std::string& text : row) text = markdown_text(text);
  const auto head = rows.front();
  rows.erase(rows.begin());
  out += markdown_table(head, rows);
  const std::string lonely = only_lines(c.only_a, "A") + only_lines(c.only_b, "B");
  if (!lonely.empty()) out += "\n" + lonely;
  for (const Check& check : checks) {
    const auto sentences = breaches(c, check);
    out += fmt::format(
        "\n{} {}\n", sentences.empty() ? "Passed:" : "**Failed:**", markdown_text(check.text));
    for (const std::string& sentence : sentences) out += "- " + markdown_text(sentence) + "\n";
  }
  return out;
}

}  // namespace libchar
