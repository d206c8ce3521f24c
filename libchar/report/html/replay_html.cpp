// report.html of a replay: which algorithm to use, what it costs, and why one may believe it.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <string>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/replay/view/replay_view.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/tables/replay_tables.hpp"
#include "libchar/report/replay/replay_text.hpp"

namespace libchar {
namespace {

// The figures of a replay's page, in their sections; replay_page.js draws into them. "": nothing to draw.

std::string of_input(const ReplayResult& r, std::size_t j) {
  return r.inputs.size() > 1 && j < r.inputs.size() ? " of " + r.inputs[j].name : "";
}

std::string joined_sentences(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + " " + b;
}

std::string marked_text(const ReplayView& view) {
  bool fault = false, found = false;
  std::string out;
  for (const RunMark& mark : view.run.marks) {
    fault |= mark.kind == "fault";
    found |= mark.kind == "found";
    if (mark.sensor.empty())
      out = joined_sentences(
          out, fmt::format("Grey: {} ({} … {}).", mark.label, duration_text(mark.from_s), duration_text(mark.to_s)));
  }
  if (found)
    out = joined_sentences(fmt::format("Pale stretches: what {} found, and nobody declared.", view.run.method), out);
  return joined_sentences(fault ? "Coloured stretches: faults of the scene." : "", out);
}

std::string signal_caption(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out = r.has_reference ? "Reference, estimate of " : "Estimate of ";
  out += view.run.method;
  if (!view.run.sensor.empty()) out += ", and " + view.run.sensor + ", the best single sensor";
  const std::size_t stretches = r.tracks.whole.inputs[0].estimate.time_s.size();
  out += stretches < r.instants
             ? fmt::format(
                   ": smallest and largest in each of {} stretches of {}; the buttons show every instant of a stretch.",
                   stretches, duration_text(view.duration_s / static_cast<double>(stretches)))
             : ", at every instant.";
  return joined_sentences(out, marked_text(view));
}

std::string run_plots_of(const ReplayView& view, std::size_t j) {
  const ReplayResult& r = *view.result;
  const std::string unit = detail::usual_unit(r.inputs[j].unit);
  std::string out = plot_figure(
      "signal", j,
      {r.inputs[j].name + " over the run", r.inputs[j].name, unit, j == 0 ? signal_caption(view) : marked_text(view)},
      view.title);
  if (r.has_reference)
    out += plot_figure("error", j,
                       {"Error: estimate − reference" + of_input(r, j), "error", unit,
                        "The same stretches. Larger errors of the single sensor are cut off where they would hide the "
                        "fused estimate's."},
                       view.title);
  return out;
}

std::string window_plots(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out;
  for (std::size_t j = 0; j < view.inputs.size(); ++j)
    if (view.inputs[j].has_window_rms)
      out += plot_figure(
          "window", j,
          {"RMS of the error in a window" + of_input(r, j), "window RMS", detail::usual_unit(r.inputs[j].unit),
           fmt::format(
               "Window of {} centred on each instant. Band: smallest and largest value in each bin of the plot.",
               duration_text(r.window_s))},
          view.title);
  return out;
}

std::string allan_plots(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out;
  for (std::size_t j = 0; j < view.inputs.size(); ++j)
    if (view.inputs[j].has_allan)
      out += plot_figure("error-allan", j,
                         {"Allan deviation of the error" + of_input(r, j), "overlapping Allan deviation",
                          detail::usual_unit(r.inputs[j].unit),
                          "Noise that averaging removes falls with τ; a level or rising curve is drift."},
                         view.title);
  return out;
}

// As many lines as replay_page.js draws of a large array.
constexpr std::size_t kMostLines = 24;

std::string lines_drawn(const ReplayResult& r, const char* which) {
  return r.sensors.size() <= kMostLines
             ? "One line per sensor; shading: range in each bin."
             : fmt::format(
                   "One line per sensor, of {} sensors the {} with the {} at the end; shading: range within each bin.",
                   r.sensors.size(), kMostLines, which);
}

std::string track_plots(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  const std::string& name = view.title;
  const std::string unit = r.sensors.empty() ? "" : detail::usual_unit(r.sensors[0].unit);
  std::string out;
  if (view.figures.weights)
    out += plot_figure("weights", 0, {"Weights", "weight", "", lines_drawn(r, "largest weights")}, name);
  if (view.figures.variances)
    out += plot_figure(
        "variances", 0,
        {"Noise variances as estimated", "variance", unit.empty() ? "" : "(" + unit + ")²",
         lines_drawn(r, "smallest variances") +
             (r.has_reference ? " Dotted: mean square error of the sensor over the run, its bias included." : "")},
        name);
  return out;
}

constexpr const char* kStretchPlace = "<div class=\"stretch-place\"></div>\n";
constexpr const char* kChoicePlace = "<div class=\"choice-place\"></div>\n";

std::string cost_figures(const ReplayView& view) {
  const std::string name = score_name(*view.result), unit = score_unit(*view.result);
  std::string plots;
  if (view.figures.error_over_time)
    plots += plot_figure("cost-time", 0,
                         {"Error against run time", name, unit,
                          "Lower and further left is better. Dashed: the Pareto front, on which no method is beaten in "
                          "both; pale marks are. Large mark: the best. Bounds (triangles) cannot be deployed."},
                         view.title);
  if (view.figures.error_over_memory)
    plots += plot_figure(
        "cost-memory", 0,
        {"Error against memory", name, unit, "Peak of the memory held from the heap, over learning and run."},
        view.title);
  return plots;
}

/// The run over time: reference, best method, best single sensor, the error of both.
std::string run_section(const ReplayView& view) {
  if (!view.figures.run) return "";
  const ReplayResult& r = *view.result;
  std::string plots;
  for (std::size_t j = 0; j < std::min(r.inputs.size(), r.tracks.whole.inputs.size()); ++j)
    plots += run_plots_of(view, j);
  if (view.figures.deviations)
    plots +=
        plot_figure("deviations", 0,
                    {"Each sensor, from the median of all", "sensor − median", detail::usual_unit(r.sensors[0].unit),
                     "Without a reference no error is known; this shows which sensors differ from the others. "
                     "Errors that all share are invisible."},
                    view.title);
  return "<section class=\"part\" id=\"run\">\n<h2>The run</h2>\n" + std::string(kStretchPlace) +
         "<div class=\"over-time run\">\n" + plots +
         "</div>\n<p class=\"note\">Drag across a plot to zoom in; double-click to show the whole "
         "run.</p>\n</section>\n";
}

/// Dots with whiskers, best first.
std::string ranking_figure(const ReplayView& view) {
  if (!view.figures.ranking) return "";
  const ReplayResult& r = *view.result;
  return "<div class=\"ranked\">\n" +
         plot_figure("ranking", 0,
                     {score_name(r) + " of each method", score_name(r), score_unit(r),
                      "Whiskers: 95 % interval, none where the error walks or drifts. Shaded: as good as the best, by "
                      "a difference below 1 % or not resolved by this record. Hollow: bounds, which use the reference "
                      "of the run itself."},
                     view.title) +
         "</div>\n";
}

std::string detection_figure(const ReplayView& view) {
  if (!view.figures.detection) return "";
  return "<div class=\"plots\">\n" +
         plot_figure("detection", 0,
                     {"Delay against false alarms", "delay", "s",
                      "Delay from each known fault to its detection, for one false alarm of the array in the time on "
                      "the axis. No point: not found while it lasted."},
                     view.title) +
         "</div>\n";
}

/// When which sensor was out, against the faults that the scene knows.
std::string faults_figure(const ReplayView& view) {
  if (!view.figures.faults) return "";
  return std::string(kChoicePlace) + "<div class=\"over-time faults\">\n" +
         plot_figure("faults", 0,
                     {"Faults and findings", "sensor", "",
                      "Broad grey bars: faults of the scene, with the delay until they were found. Narrow bars: the "
                      "sensor was not used, and the finding that caused it; hollow bars: re-weighted for its noise, "
                      "still in use. Row leads: a network leads instead of the baseline, and why it stopped."},
                     view.title) +
         "</div>\n" + detection_figure(view);
}

/// Window RMS, weights, variances, Allan deviation of the error.
std::string time_section(const ReplayView& view) {
  const std::string plots = window_plots(view) + track_plots(view), allan = allan_plots(view);
  if (plots.empty() && allan.empty()) return "";
  std::string out = "<section class=\"part\" id=\"time\">\n<h2>Over time</h2>\n";
  if (!plots.empty()) out += kStretchPlace;
  if (view.result->has_reference) out += "<div id=\"shown-place\"></div>\n";
  if (view.figures.weights || view.figures.variances) out += kChoicePlace;
  out += "<div class=\"plots over-time\">\n" + plots + "</div>\n";
  if (!allan.empty()) out += "<div class=\"plots\">\n" + allan + "</div>\n";
  return out + "</section>\n";
}

/// Each sensor beside what fusing them gives.
std::string sensors_figure(const ReplayView& view) {
  if (!view.figures.sensors) return "";
  const std::string unit = detail::usual_unit(view.result->sensors[0].unit);
  return "<div class=\"plots\">\n" +
         plot_figure("sensors", 0,
                     {"Error of each sensor", "RMSE", unit,
                      "Filled: RMSE of the sensor over the run, with its 95 % interval. Hollow: noise of a sample as "
                      "given to the algorithms. A sensor far above its noise failed, saturated or is not calibrated."},
                     view.title) +
         "</div>\n";
}

/// Error against run time and memory; folded where the run time decides nothing.
std::string cost_section(const ReplayView& view) {
  const std::string plots = cost_figures(view);
  if (plots.empty()) return "";
  const std::string all = "<div class=\"plots cost\">\n" + plots + "</div>\n";
  std::string out = "<section class=\"part\" id=\"cost\">\n<h2>Error against cost</h2>\n";
  if (view.figures.time_matters) return out + all + "</section>\n";
  return out +
         fmt::format("<p>At {} every method takes less than {} of one core: run time decides nothing here.</p>\n",
                     detail::frequency_text(view.result->rate_hz, 6), percent_text(kCoreThatMatters)) +
         folded("Error against run time and memory", all) + "</section>\n";
}

// What the columns mean.
std::string scores_note(const ReplayView& view) {
  if (!view.result->has_reference)
    return "<p class=\"note\">Without a reference no true error is known. Leave-one-out RMS: of (the estimate from all "
           "other sensors) − (the sensor left out), geometric mean over the sensors, so that a bad one counts no more "
           "than a good one; it includes that sensor's own noise. Split-array RMS: of half the difference between the "
           "estimates from two halves of the array. Neither shows an error that all sensors share.</p>\n";
  return "<p class=\"note\">Below each figure: its 95 % interval; none where the error walks or drifts. Regret: excess "
         "of the RMSE over the optimum of " +
         view.optimum +
         " on this run; a method that follows changes may be better than that. “× best method”: interval of the ratio "
         "of RMSEs over the same instants; if it contains 1, the difference is not resolved, unless the error "
         "is larger in every stretch of the run. Converged: from here on the window RMS stays within a tenth of its "
         "final level. Bounds use the reference of the run itself: they are for comparison only. Click a column's head "
         "to sort by it.</p>\n";
}

// Costs are worth a word only where they could decide.
std::string overview(const ReplayView& view, const std::vector<std::string>& next) {
  std::string out = "<section id=\"overview\">\n<div class=\"verdict\">\n";
  for (const std::string& sentence : view.shown_verdict) out += "<p>" + html_text(sentence) + "</p>\n";
  return out + "</div>\n<p class=\"facts\">" + html_text(fmt::format("{}", fmt::join(run_facts(view), " "))) +
         "</p>\n" + next_part(next) + "</section>\n";
}

std::string headed_list(const char* head, const std::vector<std::string>& items, const char* css) {
  return items.empty() ? "" : fmt::format("<h3>{}</h3>\n", head) + bullet_list(items, css);
}

std::string shown(const Table& table, const PageTable& look = {}) {
  return table.rows.empty() ? "" : html_table(table, look);
}

std::string skipped_part(const ReplayView& view) {
  std::size_t methods = 0;
  for (const SkippedAlgorithms& one : view.skipped) methods += one.labels.size();
  return methods == 0
             ? ""
             : folded("Skipped: " + plural(methods, "method"), bullet_list(skipped_words(view), "plain skipped"));
}

std::string ranking_section(const ReplayView& view) {
  constexpr PageTable kLook{.css = "ranking", .sorted = true};
  std::string inputs;
  for (const Table& table : input_tables(view)) inputs += html_table(table, kLook);
  return "<section class=\"part\" id=\"ranking\">\n<h2>Ranking</h2>\n" + ranking_figure(view) +
         html_table(algorithms_table(view), kLook) + scores_note(view) + inputs + skipped_part(view) + "</section>\n";
}

std::string needs(const ReplayView& view) {
  return "<section class=\"part\" id=\"needs\">\n<h2>What each algorithm needs</h2>\n" +
         folded("Needs, cost and source of all", html_table(needs_table(view))) + "</section>\n";
}

std::string faults(const ReplayView& view) {
  const std::string figure = faults_figure(view);
  const std::string table = shown(faults_table(view), {.most = 60, .rest = "report.json"});
  if (figure.empty() && table.empty()) return "";
  return "<section class=\"part\" id=\"faults\">\n<h2>Faults</h2>\n" + figure + table + shown(out_share_table(view)) +
         "</section>\n";
}

std::string weights(const ReplayView& view) {
  const Table table = weights_table(view);
  return table.rows.empty() ? ""
                            : "<section class=\"part\" id=\"weights\">\n<h2>Weights and noise levels of the "
                              "run</h2>\n<div class=\"copy-place\" data-copy=\"weights\"></div>\n" +
                                  html_table(table) + "</section>\n";
}

std::string sensors(const ReplayView& view) {
  return "<section class=\"part\" id=\"sensors\">\n<h2>Sensors</h2>\n" + sensors_figure(view) +
         html_table(sensors_table(view)) + shown(blind_table(view)) + "</section>\n";
}

std::string inputs(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  Table out("|");
  out.title = "Input";
  out.add({"Scene", r.scene.file});
  if (r.scene.simulate) out.add({"Simulated", fmt::format("seed {}", r.scene.simulate->seed)});
  for (const LogInfo& log : r.logs) add_input_file(out, log);
  if (r.learning) out.add({"Learning window", stretch_text(r.learning->from_s, r.learning->to_s)});
  out.add({"Evaluation", stretch_text(r.start_s, view.end_s)});
  add_program(out, r.command);
  return html_table(out, {.css = "facts"});
}

std::string provenance(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out = "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n<div class=\"two-columns\">\n<div>\n" +
                    inputs(view) + "</div>\n<div>\n" + "<div class=\"wide\">" + warnings_part(view.warnings) +
                    "</div>\n" + headed_list("What the algorithms remark", remark_words(view), "cautions") +
                    "</div>\n</div>\n";
  if (!r.plan.empty())
    out +=
        "<details><summary>The plan: what was read, learnt, run and skipped</summary>\n" +
        bullet_list(r.plan, "plain") +
        fmt::format(
            "<p class=\"note\">Done: {} passes over the samples, {} instants learnt, {} fused{}; both summed over "
            "algorithms.</p>\n",
            r.work.passes, count_text(r.work.learnt), count_text(r.work.steps),
            r.work.blind_steps > 0 ? ", " + count_text(r.work.blind_steps) + " more for the scores without a reference"
                                   : "") +
        "</details>\n";
  return out + settings_details(json_of(r.settings)) + "</section>\n";
}

}  // namespace

std::string replay_html(const ReplayView& view, const std::vector<std::string>& next) {
  Json document = replay_json(view);
  document.erase("measured");
  return html_page({"Sensor fusion", view.title, std::string(replay_page_js()),
                    std::string(page_css()) + std::string(replay_page_css())},
                   overview(view, next) + run_section(view) + ranking_section(view) + faults(view) +
                       time_section(view) + weights(view) + alignment_html(view) + sensors(view) + cost_section(view) +
                       needs(view) + provenance(view),
                   json_in_script(document));
}

std::string replay_html(const ReplayResult& result) { return replay_html(replay_view(result)); }

}  // namespace libchar
