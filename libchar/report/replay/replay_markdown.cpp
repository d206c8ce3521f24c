#include "libchar/report/replay/replay_markdown.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/replay/view/preparation_words.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/alignment_pieces.hpp"

namespace libchar {
namespace {

std::string with_reference(const ReplayView& view) {
  std::string out =
      "| algorithm | RMSE | 95 % | regret | bias | maximum | availability | a sample | memory |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const AlgorithmView* v : view.ranked) {
    const AlgorithmResult* a = v->result;
    const bool scored = !a->inputs.empty();
    out += fmt::format("| {}{}{} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                       markdown_text(a->label),
                       a->bound ? " (bound)" : "",
                       a->as_good_as_best && !a->bound ? " \\*" : "",
                       number_text(a->rmse),
                       interval_text(a->rmse_ci95),
                       excess_text(a->regret),
                       scored ? brief_text(a->inputs[0].error.bias, 2) : "–",
                       scored ? brief_text(a->inputs[0].error.maximum, 3) : "–",
                       percent_text(a->availability, 4),
                       duration_text(1e-9 * a->ns_per_sample),
                       bytes_text(a->peak_bytes));
  }
  return out;
}

std::string without_reference(const ReplayView& view) {
  std::string out =
      "| algorithm | leave-one-out RMS | 95 % | split-array RMS | availability | a sample | memory "
      "|\n"
      "|---|---|---|---|---|---|---|\n";
  for (const AlgorithmView* v : view.ranked) {
    const AlgorithmResult* a = v->result;
    out += fmt::format("| {}{} | {} | {} | {} | {} | {} | {} |\n",
                       markdown_text(a->label),
                       a->as_good_as_best ? " \\*" : "",
                       number_text(a->rmse),
                       interval_text(a->rmse_ci95),
                       a->blind ? brief_text(a->blind->split_rms, 4) : "–",
                       percent_text(a->availability, 4),
                       duration_text(1e-9 * a->ns_per_sample),
                       bytes_text(a->peak_bytes));
  }
  return out;
}

std::string several_inputs(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (r.inputs.size() < 2 || !r.has_reference) return "";
  std::string out;
  for (std::size_t j = 0; j < r.inputs.size(); ++j) {
    out += fmt::format(
        "\n### {}\nOptimum {}.\n\n| algorithm | RMSE | 95 % | of the optimum "
        "|\n|---|---|---|---|\n",
        markdown_text(r.inputs[j].name),
        error_text(r.inputs[j].optimum_rmse, markdown_text(r.inputs[j].unit)));
    for (const AlgorithmView* v : view.ranked) {
      const AlgorithmResult* a = v->result;
      if (j >= a->inputs.size()) continue;
      out += fmt::format("| {} | {} | {} | {} |\n",
                         markdown_text(a->label),
                         number_text(a->inputs[j].error.rmse),
                         interval_text(a->inputs[j].error.rmse_ci95),
                         brief_text(a->inputs[j].optimum_ratio, 4));
    }
  }
  return out;
}

std::string sensors_section(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out =
      "\n## Sensors\n\n| sensor | unit | RMSE | bias | missing | noise of a sample | from "
      "|\n|---|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < r.sensors.size(); ++i) {
    const SensorResult& s = r.sensors[i];
    out += fmt::format("| {}{} | {} | {} | {} | {} | {} | {} |\n",
                       markdown_text(s.name),
                       s.constant           ? " (constant)"
                       : !s.copy_of.empty() ? " (= " + markdown_text(s.copy_of) + ")"
                                            : "",
                       markdown_text(s.unit),
                       brief_text(s.error.rmse, 4),
                       brief_text(s.error.bias, 2),
                       percent_text(s.missing),
                       view.noise_sd[i] ? brief_text(*view.noise_sd[i], 4) : "–",
                       s.noise_source.empty() ? "–" : markdown_text(s.noise_source));
  }
  return out;
}

std::string delay(const std::optional<double>& seconds) {
  return seconds ? duration_text(*seconds) : "never";
}

std::string fault_words(const ReplayResult& r, const SensorFault& fault) {
  const bool valueless = fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout;
  return fmt::format(
      "| {} {} {} from {} s{} |",
      markdown_text(r.sensors[fault.sensor].name),
      name_of(fault.kind),
      valueless ? "" : brief_text(fault.value, 4),
      brief_text(fault.from_s, 6),
      std::isfinite(fault.to_s) ? fmt::format(" to {} s", brief_text(fault.to_s, 6)) : "");
}

std::string faults_section(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (r.faults.empty()) return "";
  std::string out = "\n## Faults\n\n| fault |", line = "\n|---|";
  for (const AlgorithmView* a : view.watching) {
    out += fmt::format(" {}: found after | used again after |", markdown_text(a->result->label));
    line += "---|---|";
  }
  out += line + "\n";
  for (std::size_t f = 0; f < r.faults.size(); ++f) {
    out += fault_words(r, r.faults[f]);
    for (const AlgorithmView* a : view.watching) {
      const FaultAnswer* answer = a->answers[f];
      const bool ends = std::isfinite(r.faults[f].to_s);
      out += fmt::format(" {} | {} |",
                         answer != nullptr ? delay(answer->found_s) : "–",
                         answer != nullptr && ends ? delay(answer->returned_s) : "–");
    }
    out += "\n";
  }
  return out;
}

// What one false alarm more often buys.
std::string detection_section(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!view.figures.detection) return "";
  std::string out = "\n| one false alarm in |", line = "\n|---|";
  for (const FaultAnswer& answer : r.detection[0].answers) {
    const SensorFault& fault = r.faults[answer.fault];
    out += fmt::format(" {} {} from {} s: found after |",
                       markdown_text(r.sensors[fault.sensor].name),
                       name_of(fault.kind),
                       brief_text(fault.from_s, 6));
    line += "---|";
  }
  out += " alarms where no fault is known |" + line + "---|\n";
  for (const DetectionAt& at : r.detection) {
    out += fmt::format("| {} |", duration_text(at.false_alarm_s));
    for (const FaultAnswer& answer : at.answers) out += fmt::format(" {} |", delay(answer.found_s));
    out += fmt::format(" {} |\n", at.alarms_without_fault);
  }
  return out;
}

std::string remarks_section(const ReplayView& view) {
  std::string out;
  const auto add = [&](const std::string& of, const std::string& message, std::uint64_t count) {
    out += fmt::format("- {}{}{}\n",
                       of.empty() ? "" : markdown_text(of) + ": ",
                       markdown_text(message),
                       count > 1 ? fmt::format(" ({} ×)", count) : "");
  };
  for (const Warning& w : view.result->warnings.list()) add("", w.sentence, w.count);
  for (const LogInfo& log : view.result->logs)
    for (const Warning& w : log.warnings.list()) add(log.file, w.sentence, w.count);
  for (const AlgorithmRemark& remark : view.remarks)
    add(remark.label, remark.message, remark.count);
  return out.empty() ? "" : "\n## Warnings\n\n" + out;
}

std::string run_facts(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out = fmt::format("{} sensors, {} instants at {} Hz from {} s.",
                                r.sensors.size(),
                                r.instants,
                                brief_text(r.rate_hz, 6),
                                brief_text(r.start_s, 6));
  if (r.has_reference && std::isfinite(r.inputs[0].optimum_rmse))
    out += fmt::format(" Optimum of {}: RMSE {}.",
                       view.optimum,
                       error_text(r.inputs[0].optimum_rmse, markdown_text(r.inputs[0].unit)));
  if (r.lag_estimated)
    out += fmt::format(" The sensors lag the reference by {} (estimated).", duration_text(r.lag_s));
  for (const std::string& sentence : preparation_words(r)) out += " " + markdown_text(sentence);
  return out;
}

std::string skipped_section(const ReplayView& view) {
  if (view.skipped.empty()) return "";
  std::string out = "\n## Skipped\n\n";
  for (const SkippedAlgorithms& s : view.skipped)
    out += fmt::format("- {}: {}\n",
                       markdown_text(fmt::format("{}", fmt::join(s.labels, ", "))),
                       markdown_text(s.reason));
  return out;
}

}  // namespace

std::string replay_markdown(const ReplayView& view) {
  std::string out =
      fmt::format("# {}\n\n{}\n\n",
                  markdown_text(view.title),
                  markdown_text(fmt::format("{}", fmt::join(view.shown_verdict, " "))));
  out += run_facts(view) + "\n\n" +
         (view.result->has_reference ? with_reference(view) : without_reference(view));
  out +=
      "\n\\* the best method, and those whose difference from it is not resolved; bounds look at "
      "the reference of the run itself.\n";
  return out + skipped_section(view) + several_inputs(view) + alignment_markdown(view) +
         sensors_section(view) + faults_section(view) + detection_section(view) +
         remarks_section(view);
}

std::string replay_markdown(const ReplayResult& result) {
  return replay_markdown(replay_view(result));
}

}  // namespace libchar
