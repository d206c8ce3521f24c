// report.html of a replay: which algorithm to use, what it costs, and why one may believe it.

#include "libchar/report/html/replay_html.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/process/version.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/replay/view/preparation_words.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/alignment_pieces.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/html/replay_figures.hpp"
#include "libchar/report/detail/html/replay_tables.hpp"
#include "libchar/report/detail/replay_words.hpp"
#include "libchar/report/json/replay_json.hpp"

namespace libchar {
namespace {

std::string facts(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out = fmt::format(
      "<p class=\"facts\"><b>{}</b> sensors · <b>{}</b> instants at <b>{}</b> Hz · <b>{}</b>",
      r.sensors.size(),
      count_text(r.instants),
      brief_text(r.rate_hz, 6),
      html_text(duration_text(view.duration_s)));
  if (r.has_reference) {
    out += " · reference: " + html_text(r.reference_use);
    for (const InputResult& input : r.inputs)
      if (std::isfinite(input.optimum_rmse))
        out += fmt::format(" · optimum{} RMSE <b>{}</b>",
                           r.inputs.size() > 1 ? " of " + html_text(input.name) : "",
                           html_text(with_unit(input.optimum_rmse, 4, usual_unit(input.unit))));
  } else {
    out += " · <b>no reference</b>";
  }
  if (r.lag_estimated)
    out += " · the sensors lag the reference by <b>" + html_text(duration_text(r.lag_s)) +
           "</b> (estimated)";
  for (const std::string& sentence : preparation_words(r)) out += " · " + html_text(sentence);
  return out + "</p>\n";
}

// What the columns mean.
std::string scores_note(const ReplayView& view) {
  if (!view.result->has_reference)
    return "<p class=\"note\">Without a reference no true error is known. Leave-one-out RMS: of "
           "(the "
           "estimate from all other sensors) − (the sensor left out), geometric mean over the "
           "sensors, so that a bad one counts no more "
           "than a good one; it holds that sensor's own noise. Split-array RMS: of half the "
           "difference between the estimates "
           "from two halves of the array. Neither sees an error that all sensors share.</p>\n";
  return "<p class=\"note\">Below each figure: its 95 % interval; none where the error walks or "
         "drifts. "
         "× best possible: "
         "RMSE ÷ RMSE of the optimum of " +
         view.optimum +
         " on this run; a method that follows changes may be below 1. “× best method”: interval of "
         "the ratio of RMSEs, from what both saw at the same time; when it holds 1 the difference "
         "is not resolved. "
         "Converged: from here on the window RMS stays within a tenth of its final level. Bounds "
         "look at the reference of the run itself: they are for comparison. A click on a column's "
         "head sorts by it.</p>\n";
}

// Costs are worth a word only where they could decide.
std::string overview(const ReplayView& view) {
  std::string out = "<section id=\"overview\">\n<div class=\"verdict\">\n";
  for (const std::string& sentence : view.shown_verdict)
    out += "<p>" + html_text(sentence) + "</p>\n";
  return out + "</div>\n" + facts(view) + "</section>\n";
}

std::string skipped_list(const ReplayView& view) {
  std::vector<std::string> items;
  for (const auto& [reason, labels] : view.skipped)
    items.push_back(fmt::format("{}: {}", fmt::join(labels, ", "), reason));
  return items.empty() ? "" : "<h3>Skipped</h3>\n" + bullet_list(items, "plain skipped");
}

std::string ranking_section(const ReplayView& view) {
  return "<section class=\"part\" id=\"ranking\">\n<h2>Ranking</h2>\n" + ranking_figure(view) +
         skipped_list(view) + ranking_table(view) + scores_note(view) + inputs_table(view) +
         "</section>\n";
}

std::string needs(const ReplayView& view) {
  return "<section class=\"part\" id=\"needs\">\n<h2>What each algorithm needs</h2>\n" +
         folded("Needs, cost and source of all", needs_table(view)) + "</section>\n";
}

std::string faults(const ReplayView& view) {
  const std::string figure = faults_figure(view), table = faults_table(view);
  if (figure.empty() && table.empty()) return "";
  return "<section class=\"part\" id=\"faults\">\n<h2>Faults</h2>\n" + figure + table +
         out_share_table(view) + "</section>\n";
}

std::string weights(const ReplayView& view) {
  const std::string table = weights_table(view);
  return table.empty() ? ""
                       : "<section class=\"part\" id=\"weights\">\n<h2>Weights and noise levels "
                         "at the end</h2>\n" +
                             table + "</section>\n";
}

std::string sensors(const ReplayView& view) {
  return "<section class=\"part\" id=\"sensors\">\n<h2>Sensors</h2>\n" + sensors_figure(view) +
         sensors_table(view) + blind_table(view) + "</section>\n";
}

std::string remarks(const ReplayView& view) {
  std::vector<std::string> items;
  for (const AlgorithmRemark& remark : view.remarks)
    items.push_back((remark.label.empty() ? "" : remark.label + ": ") + remark.message +
                    (remark.count > 1 ? fmt::format(" ({} ×)", remark.count) : ""));
  return items.empty() ? ""
                       : "<h3>What the algorithms remark</h3>\n" + bullet_list(items, "cautions");
}

std::string inputs(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out = "<h3>Input</h3>\n<table class=\"facts\"><tbody>\n";
  out += table_row({"Scene", r.scene.file});
  if (r.scene.simulate)
    out += table_row({"Simulated", fmt::format("seed {}", r.scene.simulate->seed)});
  for (const LogInfo& log : r.logs) {
    out += table_row({"File",
                      log.file + " (" + log.format + ", " + count_text(log.bytes) + " bytes, " +
                          count_text(log.rows) + " rows)"});
    out += "<tr><th scope=\"row\">SHA-256</th><td class=\"hash\">" +
           html_text(log.sha256.empty() ? "not computed" : log.sha256) + "</td></tr>\n";
  }
  if (r.learning)
    out += table_row({"Learning window", stretch_text(r.learning->from_s, r.learning->to_s)});
  out += table_row({"Evaluation", stretch_text(r.start_s, view.end_s)});
  out += table_row({"Tool", "sensorchar " + std::string(version())});
  return out + "<tr><th scope=\"row\">Command</th><td><code>" + html_text(command_line(r.command)) +
         "</code></td></tr>\n</tbody></table>\n";
}

std::string provenance(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out =
      "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n<div "
      "class=\"two-columns\">\n<div>\n" +
      inputs(view) + "</div>\n<div>\n" + "<div class=\"wide\">" + warnings_part(view.warnings) +
      "</div>\n" + remarks(view) + "</div>\n</div>\n";
  if (!r.plan.empty())
    out += "<details><summary>The plan: what was read, learnt, run and skipped</summary>\n" +
           bullet_list(r.plan, "plain") +
           fmt::format(
               "<p class=\"note\">Done: {} passes over the samples, {} instants learnt, {} "
               "fused{}; both "
               "summed over algorithms.</p>\n",
               r.work.passes,
               count_text(r.work.learnt),
               count_text(r.work.steps),
               r.work.blind_steps > 0 ? ", " + count_text(r.work.blind_steps) +
                                            " more for the scores without a reference"
                                      : "") +
           "</details>\n";
  return out + settings_details(json_of(r.settings)) + "</section>\n";
}

}  // namespace

std::string replay_html(const ReplayView& view) {
  Json document = replay_json(view);
  document.erase("measured");
  return html_page({"Sensor fusion",
                    view.title,
                    std::string(replay_page_js()),
                    std::string(page_css()) + std::string(replay_page_css()),
                    true},
                   overview(view) + run_section(view) + ranking_section(view) + faults(view) +
                       time_section(view) + weights(view) + alignment_html(view) + sensors(view) +
                       cost_section(view) + needs(view) + provenance(view),
                   json_in_script(document));
}

std::string replay_html(const ReplayResult& result) {
  return replay_html(replay_view(result));
}

}  // namespace libchar
