#include "libchar/report/replay_markdown.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "libchar/core/text.hpp"
#include "libchar/replay/verdict.hpp"
#include "libchar/report/escape.hpp"

namespace libchar {
namespace {

std::string number(double value, int digits = 4) {
  return std::isfinite(value) ? significant(value, digits) : "–";
}

std::string between(const Interval& i) {
  return std::isfinite(i.low) && std::isfinite(i.high)
             ? fmt::format("{} … {}", number(i.low), number(i.high))
             : "–";
}

std::string percent(double share) {
  return std::isfinite(share) ? fmt::format("{:.2f} %", 100 * share) : "–";
}

std::string with_reference(const ReplayResult& r) {
  std::string out =
      "| algorithm | RMSE | 95 % | regret | bias | maximum | availability | a sample | memory |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const AlgorithmResult* a : ranked(r)) {
    const bool scored = !a->inputs.empty();
    out += fmt::format("| {}{}{} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                       markdown_text(a->label),
                       a->bound ? " (bound)" : "",
                       a->as_good_as_best && !a->bound ? " \\*" : "",
                       number(a->rmse),
                       between(a->rmse_ci95),
                       percent(a->regret),
                       scored ? number(a->inputs[0].error.bias, 2) : "–",
                       scored ? number(a->inputs[0].error.maximum, 3) : "–",
                       percent(a->availability),
                       people_nanoseconds(a->ns_per_sample),
                       people_bytes(a->peak_bytes));
  }
  return out;
}

std::string without_reference(const ReplayResult& r) {
  std::string out =
      "| algorithm | leave-one-out RMS | 95 % | split-array RMS | availability | a sample | memory "
      "|\n"
      "|---|---|---|---|---|---|---|\n";
  for (const AlgorithmResult* a : ranked(r))
    out += fmt::format("| {}{} | {} | {} | {} | {} | {} | {} |\n",
                       markdown_text(a->label),
                       a->as_good_as_best ? " \\*" : "",
                       number(a->rmse),
                       between(a->rmse_ci95),
                       a->blind ? number(a->blind->split_rms) : "–",
                       percent(a->availability),
                       people_nanoseconds(a->ns_per_sample),
                       people_bytes(a->peak_bytes));
  return out;
}

std::string several_inputs(const ReplayResult& r) {
  if (r.inputs.size() < 2 || !r.has_reference) return "";
  std::string out;
  for (std::size_t j = 0; j < r.inputs.size(); ++j) {
    out += fmt::format(
        "\n### {}\nOptimum {}.\n\n| algorithm | RMSE | 95 % | of the optimum "
        "|\n|---|---|---|---|\n",
        markdown_text(r.inputs[j].name),
        people_error(r.inputs[j].optimum_rmse, markdown_text(r.inputs[j].unit)));
    for (const AlgorithmResult* a : ranked(r)) {
      if (j >= a->inputs.size()) continue;
      out += fmt::format("| {} | {} | {} | {} |\n",
                         markdown_text(a->label),
                         number(a->inputs[j].error.rmse),
                         between(a->inputs[j].error.rmse_ci95),
                         number(a->inputs[j].optimum_ratio));
    }
  }
  return out;
}

std::string sensors(const ReplayResult& r) {
  std::string out =
      "\n## Sensors\n\n| sensor | unit | RMSE | bias | missing | noise of a sample | from "
      "|\n|---|---|---|---|---|---|---|\n";
  for (const SensorResult& s : r.sensors)
    out += fmt::format("| {}{} | {} | {} | {} | {} | {} | {} |\n",
                       markdown_text(s.name),
                       s.constant ? " (constant)" : "",
                       markdown_text(s.unit),
                       number(s.error.rmse),
                       number(s.error.bias, 2),
                       percent(s.missing),
                       s.noise_variance ? number(std::sqrt(*s.noise_variance)) : "–",
                       s.noise_source.empty() ? "–" : markdown_text(s.noise_source));
  return out;
}

std::string delay(const std::optional<double>& seconds) {
  return seconds ? significant(*seconds, 3) + " s" : "never";
}

std::string faults(const ReplayResult& r) {
  if (r.faults.empty()) return "";
  std::string out = "\n## Faults\n\n| fault |";
  std::string line = "\n|---|", rows;
  std::vector<const AlgorithmResult*> watching;
  for (const AlgorithmResult& a : r.algorithms)
    if (a.ran && a.watches_faults) {
      watching.push_back(&a);
      out += fmt::format(" {}: found after | used again after |", markdown_text(a.label));
      line += "---|---|";
    }
  for (std::size_t f = 0; f < r.faults.size(); ++f) {
    const SensorFault& fault = r.faults[f];
    rows += fmt::format(
        "| {} {} {} from {} s{} |",
        markdown_text(r.sensors[fault.sensor].name),
        name_of(fault.kind),
        fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout ? ""
                                                                           : number(fault.value),
        significant(fault.from_s, 6),
        std::isfinite(fault.to_s) ? fmt::format(" to {} s", significant(fault.to_s, 6)) : "");
    for (const AlgorithmResult* a : watching) {
      const FaultAnswer* answer = nullptr;
      for (const FaultAnswer& candidate : a->answers)
        if (candidate.fault == f) answer = &candidate;
      rows += fmt::format(
          " {} | {} |",
          answer != nullptr ? delay(answer->found_s) : "–",
          answer != nullptr && std::isfinite(fault.to_s) ? delay(answer->returned_s) : "–");
    }
    rows += "\n";
  }
  return out + line + "\n" + rows;
}

std::string remarks(const ReplayResult& r) {
  std::string out;
  const auto add = [&](const Warnings& list, const std::string& of) {
    for (const Warning& w : list.list())
      out += fmt::format("- {}{}{}\n",
                         of.empty() ? "" : markdown_text(of) + ": ",
                         markdown_text(w.message),
                         w.count > 1 ? fmt::format(" ({} ×)", w.count) : "");
  };
  add(r.warnings, "");
  for (const LogInfo& log : r.logs) add(log.warnings, log.file);
  for (const AlgorithmResult& a : r.algorithms)
    for (const Warning& w : a.remarks.list()) {
      Warnings one;
      one.add(w.code, w.message, "", w.count);
      add(one, w.message.starts_with(a.label) ? "" : a.label);
    }
  return out.empty() ? "" : "\n## Warnings\n\n" + out;
}

}  // namespace

std::string replay_markdown(const ReplayResult& r) {
  std::string out = fmt::format("# {}\n\n{}\n\n",
                                markdown_text(r.scene.name.empty() ? r.scene.file : r.scene.name),
                                markdown_text(replay_verdict(r)));
  out += fmt::format("{} sensors, {} instants at {} Hz from {} s.",
                     r.sensors.size(),
                     r.instants,
                     significant(r.rate_hz, 6),
                     significant(r.start_s, 6));
  if (r.has_reference && std::isfinite(r.inputs[0].optimum_rmse))
    out += fmt::format(" Optimum of {}: RMSE {}.",
                       optimum_of(r),
                       people_error(r.inputs[0].optimum_rmse, markdown_text(r.inputs[0].unit)));
  if (r.lag_estimated)
    out +=
        fmt::format(" The sensors lag the reference by {} s (estimated).", significant(r.lag_s, 3));
  out += "\n\n" + (r.has_reference ? with_reference(r) : without_reference(r));
  out +=
      "\n\\* the best method, and those whose difference from it is not resolved; bounds look at "
      "the reference of the run itself.\n";
  if (const auto skipped = skipped_algorithms(r); !skipped.empty()) {
    out += "\n## Skipped\n\n";
    for (const SkippedAlgorithms& s : skipped)
      out += fmt::format("- {}: {}\n",
                         markdown_text(fmt::format("{}", fmt::join(s.labels, ", "))),
                         markdown_text(s.reason));
  }
  return out + several_inputs(r) + sensors(r) + faults(r) + remarks(r);
}

}  // namespace libchar
