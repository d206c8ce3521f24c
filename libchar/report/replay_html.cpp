// report.html of a replay: which algorithm to use, what it costs, and why one may believe it.

#include "libchar/report/replay_html.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/version.hpp"
#include "libchar/replay/preparation_words.hpp"
#include "libchar/report/detail/alignment_pieces.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html_page.hpp"
#include "libchar/report/detail/html_plots.hpp"
#include "libchar/report/detail/html_tables.hpp"
#include "libchar/report/detail/replay_tables.hpp"
#include "libchar/report/detail/replay_words.hpp"
#include "libchar/report/replay_json.hpp"

namespace libchar {
namespace {

std::string facts(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out = fmt::format(
      "<p class=\"facts\"><b>{}</b> sensors · <b>{}</b> instants at <b>{}</b> Hz · <b>{}</b>",
      r.sensors.size(),
      count_text(r.instants),
      significant(r.rate_hz, 6),
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
         "Regret: "
         "RMSE ÷ RMSE of the optimum of " +
         view.optimum +
         " on this run, minus 1; beyond 100 % the ratio itself. “× best”: interval of the ratio of "
         "RMSEs, from what both saw at the same time; when it holds 1 the difference is not "
         "resolved. "
         "Converged: from here on the window RMS stays within a tenth of its final level. Bounds "
         "look at the reference of the run itself: they are for comparison. A click on a column's "
         "head sorts by it.</p>\n";
}

std::string overview(const ReplayView& view) {
  std::string out = "<section id=\"overview\">\n<div class=\"verdict\">\n";
  for (const std::string& sentence : view.verdict) out += "<p>" + html_text(sentence) + "</p>\n";
  out += "</div>\n" + facts(view) + ranking_table(view);
  return out + scores_note(view) + inputs_table(view) + "</section>\n";
}

std::string skipped(const ReplayView& view) {
  std::string out = "<section class=\"part\" id=\"needs\">\n<h2>What each algorithm needs</h2>\n";
  std::vector<std::string> items;
  for (const auto& [reason, labels] : view.skipped)
    items.push_back(fmt::format("Skipped {}: {}", fmt::join(labels, ", "), reason));
  return out + bullet_list(items, "plain") +
         "<details><summary>Needs, cost and source of all</summary>\n" + needs_table(view) +
         "</details>\n</section>\n";
}

std::string cost_plots(const ReplayView& view) {
  const std::string name = score_name(*view.result), unit = score_unit(*view.result);
  std::string plots;
  if (view.figures.error_over_time)
    plots += plot_figure(
        "cost-time",
        0,
        {"Error against run time",
         name,
         unit,
         "Lower and further left is better. Dashed: the Pareto front, on which no method is "
         "beaten in both; pale marks are. Large mark: the best. Bounds (triangles) are no "
         "methods."},
        view.title);
  if (view.figures.error_over_memory)
    plots += plot_figure("cost-memory",
                         0,
                         {"Error against memory",
                          name,
                          unit,
                          "Peak of the memory held from the heap, over learning and run."},
                         view.title);
  return plots.empty() ? ""
                       : "<section class=\"part\" id=\"cost\">\n<h2>Error against cost</h2>\n<div "
                         "class=\"plots cost\">\n" +
                             plots + "</div>\n</section>\n";
}

std::string of_input(const ReplayResult& r, std::size_t j) {
  return r.inputs.size() > 1 && j < r.inputs.size() ? " of " + r.inputs[j].name : "";
}

std::string window_plots(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out;
  for (std::size_t j = 0; j < view.inputs.size(); ++j)
    if (view.inputs[j].has_window_rms)
      out += plot_figure(
          "window",
          j,
          {"RMS of the error in a window" + of_input(r, j),
           "window RMS",
           usual_unit(r.inputs[j].unit),
           fmt::format("Window of {} centred on each instant. Band: smallest and largest value "
                       "in each bin of the plot.",
                       duration_text(r.window_s))},
          view.title);
  return out;
}

std::string allan_plots(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out;
  for (std::size_t j = 0; j < view.inputs.size(); ++j)
    if (view.inputs[j].has_allan)
      out += plot_figure(
          "error-allan",
          j,
          {"Allan deviation of the error" + of_input(r, j),
           "overlapping Allan deviation",
           usual_unit(r.inputs[j].unit),
           "What averaging would remove falls with τ; what stays level or rises is drift."},
          view.title);
  return out;
}

// As many lines as replay_page.js draws of a large array.
constexpr std::size_t kMostLines = 24;

std::string lines_drawn(const ReplayResult& r, const char* which) {
  return r.sensors.size() <= kMostLines
             ? "A line a sensor; band: smallest and largest in each bin."
             : fmt::format(
                   "A line a sensor, of {} sensors the {} with the {} at the end; band: "
                   "smallest and largest in each bin.",
                   r.sensors.size(),
                   kMostLines,
                   which);
}

std::string track_plots(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  const std::string& name = view.title;
  const std::string unit = r.sensors.empty() ? "" : usual_unit(r.sensors[0].unit);
  std::string out;
  if (view.figures.weights)
    out += plot_figure(
        "weights", 0, {"Weights", "weight", "", lines_drawn(r, "largest weights")}, name);
  if (view.figures.variances)
    out += plot_figure(
        "variances",
        0,
        {"Noise variances as estimated",
         "variance",
         unit.empty() ? "" : "(" + unit + ")²",
         lines_drawn(r, "smallest variances") +
             (r.has_reference
                  ? " Dotted: mean square error of the sensor over the run, its bias included."
                  : "")},
        name);
  if (view.figures.faults)
    out += plot_figure(
        "faults",
        0,
        {"Faults",
         "sensor",
         "",
         "Broad bars: faults that the scene knows. Narrow bars: the sensor was taken out."},
        name);
  return out;
}

std::string time_plots(const ReplayView& view) {
  const std::string plots = window_plots(view) + track_plots(view), allan = allan_plots(view);
  if (plots.empty() && allan.empty()) return "";
  std::string out =
      "<section class=\"part\" id=\"time\">\n<h2>Over time</h2>\n<div "
      "id=\"stretch-place\"></div>\n";
  if (view.result->has_reference) out += "<div id=\"shown-place\"></div>\n";
  out += "<div class=\"plots over-time\">\n" + plots + "</div>\n";
  if (!plots.empty())
    out +=
        "<p class=\"note\">Drag across a plot to look at a stretch; a double click shows the whole "
        "run.</p>\n";
  if (!allan.empty()) out += "<div class=\"plots\">\n" + allan + "</div>\n";
  return out + weights_table(view) + "</section>\n";
}

std::string faults(const ReplayView& view) {
  const std::string table = faults_table(view);
  return table.empty()
             ? ""
             : "<section class=\"part\" id=\"faults\">\n<h2>Faults</h2>\n" + table + "</section>\n";
}

// Each sensor beside what fusing them gives: is it worth it?
std::string sensor_plot(const ReplayView& view) {
  if (!view.figures.sensors) return "";
  const std::string unit = usual_unit(view.result->sensors[0].unit);
  return "<div class=\"plots\">\n" +
         plot_figure("sensors",
                     0,
                     {"Error of each sensor",
                      "RMSE",
                      unit,
                      "Filled: RMSE of the sensor over the run, with its 95 % interval. Hollow: "
                      "noise of a sample as the algorithms were told. A sensor far above its noise "
                      "failed, saturated or is not calibrated."},
                     view.title) +
         "</div>\n";
}

std::string sensors(const ReplayView& view) {
  return "<section class=\"part\" id=\"sensors\">\n<h2>Sensors</h2>\n" + sensor_plot(view) +
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
                    std::string(page_css()) + std::string(replay_page_css())},
                   overview(view) + cost_plots(view) + time_plots(view) + faults(view) +
                       alignment_html(view) + sensors(view) + skipped(view) + provenance(view),
                   json_in_script(document));
}

std::string replay_html(const ReplayResult& result) {
  return replay_html(replay_view(result));
}

}  // namespace libchar
