// report.md: what of a replay fits into a pull request. Every text of a file is escaped, so that a
// sensor's name can be no link, tag or column.

#include "libchar/report/replay_markdown.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text.hpp"
#include "libchar/core/version.hpp"
#include "libchar/report/people.hpp"
#include "libchar/report/replay_words.hpp"

namespace libchar {
namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string joined(const std::vector<std::string>& all) {
  return fmt::format("{}", fmt::join(all, ", "));
}

std::string algorithms_table(const ReplayResult& r) {
  const std::string unit = score_unit(r);
  const ParetoFront front = pareto_front(r);
  std::vector<std::string> head = {
      "algorithm", score_name(r) + (unit.empty() ? "" : ", " + markdown_text(unit)), "95 %"};
  if (r.has_reference)
    for (const char* name : {"regret", "bias", "maximum"}) head.emplace_back(name);
  else
    head.emplace_back("split-array RMS");
  for (const char* name : {"available", "ns/sample", "memory", "learning", ""})
    head.emplace_back(name);
  Rows rows;
  for (const std::size_t i : ranked(r)) {
    const AlgorithmResult& a = r.algorithms[i];
    std::vector<std::string> row = {
        markdown_text(a.label), people(a.rmse), people_interval(a.rmse_ci95)};
    if (r.best == i) row[0] = "**" + row[0] + "**";
    if (r.has_reference) {
      row.push_back(people_percent(a.regret));
      row.push_back(a.inputs.empty() ? "–" : people(a.inputs[0].error.bias, 3));
      row.push_back(a.inputs.empty() ? "–" : people(a.inputs[0].error.maximum, 3));
    } else {
      row.push_back(a.blind ? people(a.blind->split_rms) : "–");
    }
    row.push_back(people_percent(a.availability, 1));
    row.push_back(people(a.ns_per_sample, 3));
    row.push_back(a.peak_bytes ? people_bytes(static_cast<double>(*a.peak_bytes)) : "–");
    row.push_back(people_seconds(a.learning_s));
    row.push_back(a.bound                            ? "bound"
                  : r.best == i                      ? "best"
                  : a.as_good_as_best                ? "not resolved from the best"
                  : front.time[i] || front.memory[i] ? "on a front"
                                                     : "");
    rows.push_back(std::move(row));
  }
  return markdown_table(head, rows);
}

std::string inputs_table(const ReplayResult& r) {
  if (r.inputs.size() < 2 || !r.has_reference) return "";
  std::vector<std::string> head = {"RMSE an input"};
  for (const InputResult& input : r.inputs)
    head.push_back(markdown_text(input.name) +
                   (input.unit.empty() ? "" : ", " + markdown_text(usual_unit(input.unit))));
  Rows rows;
  std::vector<std::string> optimum = {"optimum"};
  for (const InputResult& input : r.inputs) optimum.push_back(people(input.optimum_rmse));
  rows.push_back(optimum);
  for (const std::size_t i : ranked(r)) {
    std::vector<std::string> row = {markdown_text(r.algorithms[i].label)};
    for (const InputScore& input : r.algorithms[i].inputs) row.push_back(people(input.error.rmse));
    row.resize(head.size(), "–");
    rows.push_back(std::move(row));
  }
  return "\n" + markdown_table(head, rows);
}

std::string skipped(const ReplayResult& r) {
  const auto all = skipped_by_reason(r);
  if (all.empty()) return "";
  std::string out = "\n## Skipped\n\n";
  for (const auto& [reason, labels] : all) {
    std::vector<std::string> names;
    for (const std::string& label : labels) names.push_back(markdown_text(label));
    out += fmt::format("- {}: {}\n", joined(names), markdown_text(reason));
  }
  return out;
}

std::string sensors(const ReplayResult& r) {
  Rows rows;
  for (const SensorResult& s : r.sensors) {
    std::string note = s.constant ? "constant" : "";
    rows.push_back({markdown_text(s.name),
                    people(s.error.rmse),
                    people(s.error.bias, 3),
                    people(s.error.maximum, 3),
                    s.noise_variance ? people(std::sqrt(*s.noise_variance), 3) : "–",
                    s.missing > 0 ? people_percent(s.missing) : "none",
                    note});
  }
  return "\n## Sensors\n\n" +
         markdown_table({"sensor", "RMSE", "bias", "maximum", "noise given", "missing", ""}, rows);
}

std::string faults(const ReplayResult& r) {
  if (r.faults.empty()) return "";
  std::vector<const AlgorithmResult*> watchers;
  for (const AlgorithmResult& a : r.algorithms)
    if (a.ran && a.watches_faults) watchers.push_back(&a);
  std::vector<std::string> head = {"fault", "sensor", "from", "to"};
  for (const AlgorithmResult* a : watchers) head.push_back("found by " + markdown_text(a->label));
  Rows rows;
  for (std::size_t f = 0; f < r.faults.size(); ++f) {
    const SensorFault& fault = r.faults[f];
    std::vector<std::string> row = {
        std::string(name_of(fault.kind)),
        fault.sensor < r.sensors.size() ? markdown_text(r.sensors[fault.sensor].name) : "–",
        people_instant(fault.from_s),
        std::isfinite(fault.to_s) ? people_instant(fault.to_s) : "the end"};
    for (const AlgorithmResult* a : watchers) {
      std::string cell = "not looked at";
      for (const FaultAnswer& answer : a->answers)
        if (answer.fault == f)
          cell = !answer.found_s
                     ? "missed"
                     : "after " + people_seconds(*answer.found_s) +
                           (answer.returned_s ? ", back after " + people_seconds(*answer.returned_s)
                                              : "");
      row.push_back(cell);
    }
    rows.push_back(std::move(row));
  }
  return "\n## Faults\n\n" + markdown_table(head, rows);
}

std::string warnings(const ReplayResult& r) {
  std::string out;
  const auto add = [&](const Warnings& list, const std::string& of) {
    for (const Warning& w : list.list())
      out += fmt::format("- {}{} ({} ×)\n",
                         of.empty() ? "" : markdown_text(of) + ": ",
                         markdown_text(w.message),
                         w.count);
  };
  add(r.warnings, "");
  for (const LogInfo& log : r.logs) add(log.warnings, log.file);
  for (const AlgorithmResult& a : r.algorithms) add(a.remarks, a.label);
  return out.empty() ? "" : "\n## Warnings and remarks\n\n" + out;
}

}  // namespace

std::string markdown_text(std::string_view text) {
  std::string out;
  for (const char c : printable(text)) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      if (std::string_view("\\`*_{}[]#|!~$").find(c) != std::string_view::npos) out += '\\';
      out += c;
    }
  }
  return out;
}

std::string markdown_table(const std::vector<std::string>& head,
                           const std::vector<std::vector<std::string>>& rows) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string out = "|";
    for (const std::string& cell : cells) out += " " + cell + " |";
    return out + "\n";
  };
  std::string rule = "|";
  for (std::size_t i = 0; i < head.size(); ++i) rule += i == 0 ? "---|" : "---:|";
  std::string out = line(head) + rule + "\n";
  for (const auto& row : rows) out += line(row);
  return out;
}

std::string replay_markdown(const ReplayResult& r) {
  const std::string name = r.scene.name.empty() ? r.scene.file : r.scene.name;
  std::string out = "# Replay of " + markdown_text(name) + "\n\n";
  for (const std::string& sentence : replay_verdict(r, true)) out += markdown_text(sentence) + "\n";
  out += fmt::format("\n{} sensors, {} instants at {} Hz.",
                     r.sensors.size(),
                     r.instants,
                     significant(r.rate_hz, 6));
  if (r.has_reference && !r.inputs.empty() && std::isfinite(r.inputs[0].optimum_rmse))
    out += fmt::format(" Optimum of this scene: RMSE {}.",
                       markdown_text(with_unit(r.inputs[0].optimum_rmse, 4, score_unit(r))));
  if (r.lag_estimated)
    out +=
        fmt::format(" The sensors lag the reference by {} (estimated).", people_seconds(r.lag_s));
  out += "\n\n" + algorithms_table(r) + inputs_table(r) + skipped(r) + sensors(r) + faults(r) +
         warnings(r);
  return out + "\nWritten by sensorchar " + std::string(version()) + ".\n";
}

}  // namespace libchar
