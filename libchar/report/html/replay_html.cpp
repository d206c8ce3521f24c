// report.html of a replay: which algorithm to use, what it costs, and why one may believe it.

#include "libchar/report/html/replay_html.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/alignment_pieces.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/html/replay_figures.hpp"
#include "libchar/report/detail/replay_words.hpp"
#include "libchar/report/detail/tables/replay_tables.hpp"
#include "libchar/report/json/replay_json.hpp"

namespace libchar {
namespace {

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
         "Regret: how much RMSE is above that of the optimum of " +
         view.optimum +
         " on this run; a method that follows changes may be below it. “× best method”: interval "
         "of "
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
  return out + "</div>\n<p class=\"facts\">" +
         html_text(fmt::format("{}", fmt::join(run_facts(view), " "))) + "</p>\n</section>\n";
}

std::string headed_list(const char* head, const std::vector<std::string>& items, const char* css) {
  return items.empty() ? "" : fmt::format("<h3>{}</h3>\n", head) + bullet_list(items, css);
}

std::string shown(const Table& table, const PageTable& look = {}) {
  return table.rows.empty() ? "" : html_table(table, look);
}

std::string ranking_section(const ReplayView& view) {
  constexpr PageTable kLook{.css = "ranking", .sorted = true};
  std::string inputs;
  for (const Table& table : input_tables(view)) inputs += html_table(table, kLook);
  return "<section class=\"part\" id=\"ranking\">\n<h2>Ranking</h2>\n" + ranking_figure(view) +
         headed_list("Skipped", skipped_words(view), "plain skipped") +
         html_table(algorithms_table(view), kLook) + scores_note(view) + inputs + "</section>\n";
}

std::string needs(const ReplayView& view) {
  return "<section class=\"part\" id=\"needs\">\n<h2>What each algorithm needs</h2>\n" +
         folded("Needs, cost and source of all", html_table(needs_table(view))) + "</section>\n";
}

std::string faults(const ReplayView& view) {
  const std::string figure = faults_figure(view);
  const std::string table = shown(faults_table(view), {.most = 60, .rest = "report.json"});
  if (figure.empty() && table.empty()) return "";
  return "<section class=\"part\" id=\"faults\">\n<h2>Faults</h2>\n" + figure + table +
         shown(out_share_table(view)) + "</section>\n";
}

std::string weights(const ReplayView& view) {
  const Table table = weights_table(view);
  return table.rows.empty()
             ? ""
             : "<section class=\"part\" id=\"weights\">\n<h2>Weights and noise levels of "
               "the run</h2>\n<div class=\"copy-place\" data-copy=\"weights\"></div>\n" +
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
  std::string out =
      "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n<div "
      "class=\"two-columns\">\n<div>\n" +
      inputs(view) + "</div>\n<div>\n" + "<div class=\"wide\">" + warnings_part(view.warnings) +
      "</div>\n" + headed_list("What the algorithms remark", remark_words(view), "cautions") +
      "</div>\n</div>\n";
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
