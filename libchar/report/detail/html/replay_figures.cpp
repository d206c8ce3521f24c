#include "libchar/report/detail/html/replay_figures.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_plots.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/replay_words.hpp"
#include "libchar/report/detail/tables/replay_tables.hpp"

namespace libchar {
namespace {

std::string of_input(const ReplayResult& r, std::size_t j) {
  return r.inputs.size() > 1 && j < r.inputs.size() ? " of " + r.inputs[j].name : "";
}

std::string joined_sentences(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + " " + b;
}

std::string marked_text(const ReplayView& view) {
  bool fault = false;
  std::string out;
  for (const RunMark& mark : view.run.marks) {
    if (mark.kind == "fault")
      fault = true;
    else
      out = joined_sentences(out,
                             fmt::format("Grey: {} ({} … {}).",
                                         mark.label,
                                         duration_text(mark.from_s),
                                         duration_text(mark.to_s)));
  }
  return joined_sentences(fault ? "Coloured stretches: faults as the scene tells them." : "", out);
}

std::string signal_caption(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::string out = r.has_reference ? "Reference, estimate of " : "Estimate of ";
  out += view.run.method;
  if (!view.run.sensor.empty()) out += ", and " + view.run.sensor + ", the best single sensor";
  const std::size_t stretches = r.tracks.whole.inputs[0].estimate.time_s.size();
  out += stretches < r.instants
             ? fmt::format(
                   ": smallest and largest in each of {} stretches of {}; closer in, every "
                   "instant where the buttons lead.",
                   stretches,
                   duration_text(view.duration_s / static_cast<double>(stretches)))
             : ", at every instant.";
  return joined_sentences(out, marked_text(view));
}

std::string run_plots_of(const ReplayView& view, std::size_t j) {
  const ReplayResult& r = *view.result;
  const std::string unit = usual_unit(r.inputs[j].unit);
  std::string out = plot_figure("signal",
                                j,
                                {r.inputs[j].name + " over the run",
                                 r.inputs[j].name,
                                 unit,
                                 j == 0 ? signal_caption(view) : marked_text(view)},
                                view.title);
  if (r.has_reference)
    out += plot_figure("error",
                       j,
                       {"Error: estimate − reference" + of_input(r, j),
                        "error",
                        unit,
                        "The same stretches. What is beyond the frame of the fused estimate's "
                        "error is cut off where it would hide it."},
                       view.title);
  return out;
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
  return out;
}

constexpr const char* kStretchPlace = "<div class=\"stretch-place\"></div>\n";
constexpr const char* kChoicePlace = "<div class=\"choice-place\"></div>\n";

std::string cost_figures(const ReplayView& view) {
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
  return plots;
}

}  // namespace

std::string run_section(const ReplayView& view) {
  if (!view.figures.run) return "";
  const ReplayResult& r = *view.result;
  std::string plots;
  for (std::size_t j = 0; j < std::min(r.inputs.size(), r.tracks.whole.inputs.size()); ++j)
    plots += run_plots_of(view, j);
  if (view.figures.deviations)
    plots += plot_figure("deviations",
                         0,
                         {"Each sensor, from the median of all",
                          "sensor − median",
                          usual_unit(r.sensors[0].unit),
                          "No reference tells an error; this shows which sensors go their own way. "
                          "What all share is not seen."},
                         view.title);
  return "<section class=\"part\" id=\"run\">\n<h2>The run</h2>\n" + std::string(kStretchPlace) +
         "<div class=\"over-time run\">\n" + plots +
         "</div>\n<p class=\"note\">Drag across a plot to look at a stretch; a double click shows "
         "the whole run.</p>\n</section>\n";
}

std::string ranking_figure(const ReplayView& view) {
  if (!view.figures.ranking) return "";
  const ReplayResult& r = *view.result;
  return "<div class=\"ranked\">\n" +
         plot_figure("ranking",
                     0,
                     {score_name(r) + " of each method",
                      score_name(r),
                      score_unit(r),
                      "Whiskers: 95 % interval, none where the error walks or drifts. Shaded: as "
                      "good as the best, by a difference below 1 % or not resolved by this record. "
                      "Hollow: bounds, which look at the reference of the run itself."},
                     view.title) +
         "</div>\n";
}

std::string detection_figure(const ReplayView& view) {
  if (!view.figures.detection) return "";
  return "<div class=\"plots\">\n" +
         plot_figure("detection",
                     0,
                     {"Delay against false alarms",
                      "delay",
                      "s",
                      "How long each known fault lasts until the detector finds it, when the array "
                      "may raise one false alarm in the time on the axis (false_alarm_s). No "
                      "point: not found while it lasted."},
                     view.title) +
         "</div>\n";
}

std::string faults_figure(const ReplayView& view) {
  if (!view.figures.faults) return "";
  return std::string(kChoicePlace) + "<div class=\"over-time faults\">\n" +
         plot_figure("faults",
                     0,
                     {"Faults and findings",
                      "sensor",
                      "",
                      "Broad grey bars: faults as the scene tells them, with the delay until they "
                      "were found. Narrow bars: the sensor was out, and which finding put it "
                      "there; hollow ones: re-weighted for its noise, still in use."},
                     view.title) +
         "</div>\n" + detection_figure(view);
}

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

std::string sensors_figure(const ReplayView& view) {
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

std::string cost_section(const ReplayView& view) {
  const std::string plots = cost_figures(view);
  if (plots.empty()) return "";
  const std::string all = "<div class=\"plots cost\">\n" + plots + "</div>\n";
  std::string out = "<section class=\"part\" id=\"cost\">\n<h2>Error against cost</h2>\n";
  if (view.figures.time_matters) return out + all + "</section>\n";
  return out +
         fmt::format(
             "<p>At {} Hz every method takes less than {} of one core: run time decides "
             "nothing here.</p>\n",
             brief_text(view.result->rate_hz, 6),
             percent_text(kCoreThatMatters)) +
         folded("Error against run time and memory", all) + "</section>\n";
}

}  // namespace libchar
