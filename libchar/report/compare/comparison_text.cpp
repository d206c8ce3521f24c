#include "libchar/report/compare/comparison_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/report/detail/tables/scores.hpp"

namespace libchar {
namespace {

Json side(const AlgorithmSummary* one) {
  if (one == nullptr) return nullptr;
  return {{"status", one->ran ? "ran" : "skipped"},
          {"why", one->ran ? Json(nullptr) : Json(json_text(one->why))},
          {"rmse", json_number(one->rmse)},
          {"rmse_ci95", interval_json(one->rmse_ci95)},
          {"regret", json_number(one->regret)},
          {"ns_per_sample", json_number(one->ns_per_sample)},
          {"peak_bytes", json_number(one->peak_bytes)}};
}

Json report(const ReplaySummary& r) {
  return {{"file", json_text(r.file)},
          {"program", r.program.empty() ? Json(nullptr) : Json(json_text(r.program))},
          {"scene", json_text(r.scene_name.empty() ? r.scene_file : r.scene_name)},
          {"best", r.best.empty() ? Json(nullptr) : Json(json_text(r.best))}};
}

Json sentences(const std::vector<std::string>& list) {
  Json out = Json::array();
  for (const std::string& sentence : list) out.push_back(json_text(sentence));
  return out;
}

const AlgorithmSummary& known(const AlgorithmSummary* one) {
  static const AlgorithmSummary kNothing = [] {
    AlgorithmSummary out;
    out.rmse = out.regret = out.ns_per_sample = out.peak_bytes = kNone;
    return out;
  }();
  return one != nullptr && one->ran ? *one : kNothing;
}

/// "+4.62 %", "0 %"; "–" for no number.
std::string change_text(double change) {
  if (!std::isfinite(change)) return "–";
  if (change == 0) return "0 %";
  const double percent = 100 * change;
  return std::abs(percent) < 0.005 ? (percent > 0 ? "+0.00 %" : "-0.00 %")
                                   : fmt::format("{:+.2f} %", percent);
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
  const std::string score = c.a.has_reference ? "RMSE" : "leave-one-out RMS";
  Table out("algorithm|" + score + " A|" + score +
            " B|change|a sample A|B|change|memory A|B|error of B");
  for (const ComparedAlgorithm& row : c.algorithms) {
    const AlgorithmSummary &a = known(row.a), &b = known(row.b);
    if (!a.ran && !b.ran && row.a != nullptr && row.b != nullptr) continue;
    const std::string where = side_of(row);
    out.add({row.label,
             brief_text(a.rmse, 5),
             brief_text(b.rmse, 5),
             change_text(row.rmse_change),
             time_cell(a.ns_per_sample),
             time_cell(b.ns_per_sample),
             change_text(row.ns_change),
             memory_cell(a.peak_bytes),
             memory_cell(b.peak_bytes),
             where.empty() ? std::string(name_of(row.difference)) : where});
  }
  return out;
}

}  // namespace

Json comparison_json(const Comparison& c) {
  Json out = {{"a", report(c.a)},
              {"b", report(c.b)},
              {"verdict", json_text(c.verdict)},
              {"score", c.a.has_reference ? "rmse" : "predictive_rms"},
              {"unlike", sentences(c.unlike)},
              {"remarks", sentences(c.remarks)},
              {"algorithms", Json::array()}};
  for (const ComparedAlgorithm& row : c.algorithms)
    out["algorithms"].push_back({{"label", json_text(row.label)},
                                 {"a", side(row.a)},
                                 {"b", side(row.b)},
                                 {"difference", name_of(row.difference)},
                                 {"rmse_change", json_number(row.rmse_change)},
                                 {"ns_per_sample_change", json_number(row.ns_change)},
                                 {"peak_bytes_change", json_number(row.bytes_change)}});
  return out;
}

std::string comparison_text(const Comparison& c, std::size_t width) {
  std::string out =
      fmt::format("A: {}: {}\nB: {}: {}\n",
                  printable(c.a.file),
                  printable(c.a.scene_name.empty() ? c.a.scene_file : c.a.scene_name),
                  printable(c.b.file),
                  printable(c.b.scene_name.empty() ? c.b.scene_file : c.b.scene_name));
  for (const std::string& sentence : c.unlike) out += "unlike: " + printable(sentence) + "\n";
  for (const std::string& sentence : c.remarks) out += "differs: " + printable(sentence) + "\n";
  return out + "\n" + terminal_table(compared_table(c), {width}, "") + "\n" + printable(c.verdict) +
         "\n";
}

std::string comparison_markdown(const Comparison& c) {
  std::string out =
      fmt::format("# {}\n\n{}\n\nA: {}, program {}. B: {}, program {}.\n",
                  markdown_text(c.a.scene_name.empty() ? c.a.scene_file : c.a.scene_name),
                  markdown_text(c.verdict),
                  markdown_text(c.a.file),
                  markdown_text(c.a.program),
                  markdown_text(c.b.file),
                  markdown_text(c.b.program));
  const char* heads[] = {"These are not two replays of one scene:", "What else differs:"};
  const std::vector<std::string>* lists[] = {&c.unlike, &c.remarks};
  for (std::size_t i = 0; i < 2; ++i) {
    if (lists[i]->empty()) continue;
    out += fmt::format("\n{}\n\n", heads[i]);
    for (const std::string& sentence : *lists[i])
      out += fmt::format("- {}\n", markdown_text(sentence));
  }
  return out + "\n" + table_text(compared_table(c)) +
         "\nResolved: the 95 % intervals of the two do not overlap.\n";
}

}  // namespace libchar
