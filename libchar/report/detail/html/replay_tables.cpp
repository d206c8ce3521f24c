#include "libchar/report/detail/html/replay_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/replay_words.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostFaultRows = 60;

// A cell with the number that the column is sorted by; empty: none. `css` "n more": of a column that
// is folded at first.
std::string cell(const std::string& shown,
                 double value,
                 const std::string& below = "",
                 const char* css = "n") {
  return fmt::format("<td class=\"{}\" data-value=\"{}\">{}{}</td>",
                     css,
                     std::isfinite(value) ? shortest(value) : "",
                     html_text(shown),
                     below.empty() ? "" : "<span class=\"ci\">" + html_text(below) + "</span>");
}

std::string chips_of(const AlgorithmView& v) {
  const AlgorithmResult& a = *v.result;
  std::string out;
  const auto chip = [&](const char* css, const char* text) {
    out += fmt::format(" <span class=\"chip {}\">{}</span>", css, text);
  };
  if (v.best) chip("detected", "best");
  if (a.bound) chip("", "bound");
  if (!a.bound && !v.best && a.as_good_as_best) chip("unsure", "not resolved from the best");
  if (!a.bound && v.learns) chip("", "learns from a reference");
  if (v.on_time_front && v.on_memory_front)
    chip("", "fronts: time, memory");
  else if (v.on_time_front || v.on_memory_front)
    chip("", v.on_time_front ? "front: time" : "front: memory");
  return out;
}

std::string name_cell(const AlgorithmView& v) {
  const AlgorithmResult& a = *v.result;
  const auto below = [](const std::string& text) {
    return text.empty() ? "" : "<span class=\"ci dim\">" + html_text(text) + "</span>";
  };
  return "<th scope=\"row\">" + html_text(a.label) + chips_of(v) +
         (a.description != nullptr ? below(std::string(a.description->title)) : "") +
         below(v.settings) + "</th>";
}

const char* css_of(const AlgorithmView& v) {
  return v.best ? "best" : v.result->bound ? "bound" : "";
}

// "1.0016 ×", "18 ×": four decimals, for a few hundredths of a per cent can be resolved.
std::string times_text(double ratio) {
  if (!std::isfinite(ratio)) return "–";
  return (ratio < 10 ? fmt::format("{:.4f}", ratio) : number_text(ratio, 4)) + " ×";
}

/// A column of the ranking: its head, and whether it is folded at first.
struct RankingColumn {
  std::string head;
  bool more;
  std::string (*cell)(const AlgorithmResult& a, const char* css);
};

const ErrorScore& score_of(const AlgorithmResult& a) {
  static const ErrorScore none = [] {
    ErrorScore e;
    e.rmse = e.bias = e.maximum = e.converged_s = std::nan("");
    e.bias_ci95 = {std::nan(""), std::nan("")};
    return e;
  }();
  return a.inputs.empty() ? none : a.inputs[0].error;
}

std::string score_cell(const AlgorithmResult& a, const char* css) {
  return cell(number_text(a.rmse),
              a.rmse,
              std::isfinite(a.rmse_ci95.low) ? interval_text(a.rmse_ci95) : "",
              css);
}

std::string possible_cell(const AlgorithmResult& a, const char* css) {
  return cell(times_text(1 + a.regret), a.regret, "", css);
}

std::string ratio_cell(const AlgorithmResult& a, const char* css) {
  if (!a.ratio_to_best || !std::isfinite(a.ratio_to_best->low))
    return cell("–", std::nan(""), "", css);
  return cell(interval_text(*a.ratio_to_best), a.ratio_to_best->low, "", css);
}

std::string bias_cell(const AlgorithmResult& a, const char* css) {
  const ErrorScore& e = score_of(a);
  return cell(number_text(e.bias, 3),
              std::fabs(e.bias),
              std::isfinite(e.bias_ci95.low) ? interval_text(e.bias_ci95, 2) : "",
              css);
}

// The scores, then what each costs; what seldom decides is folded at first.
std::vector<RankingColumn> ranking_columns(const ReplayView& view) {
  using A = const AlgorithmResult&;
  const bool reference = view.result->has_reference;
  const std::string unit = score_unit(*view.result);
  std::vector<RankingColumn> out = {
      {score_name(*view.result) + (unit.empty() ? "" : ", " + unit), false, score_cell}};
  if (reference) out.push_back({"× best possible", false, possible_cell});
  out.push_back({"× best method", false, ratio_cell});
  if (reference) {
    out.push_back({"Bias", true, bias_cell});
    out.push_back({"Maximum", true, [](A a, const char* css) {
                     return cell(number_text(score_of(a).maximum, 3), score_of(a).maximum, "", css);
                   }});
    out.push_back({"Converged", true, [](A a, const char* css) {
                     const double s = score_of(a).converged_s;
                     return cell(duration_text(s), s, "", css);
                   }});
  } else {
    out.push_back({"Split-array RMS", false, [](A a, const char* css) {
                     const double rms = a.blind ? a.blind->split_rms : std::nan("");
                     return cell(number_text(rms), rms, "", css);
                   }});
  }
  out.push_back({"Available", !view.figures.availability, [](A a, const char* css) {
                   return cell(percent_text(a.availability, 4), a.availability, "", css);
                 }});
  out.push_back({"ns a sample", !view.figures.time_matters, [](A a, const char* css) {
                   return cell(number_text(a.ns_per_sample, 3), a.ns_per_sample, "", css);
                 }});
  out.push_back({"Memory", true, [](A a, const char* css) {
                   return cell(bytes_text(a.peak_bytes),
                               a.peak_bytes ? static_cast<double>(*a.peak_bytes) : std::nan(""),
                               "",
                               css);
                 }});
  out.push_back({"Learning", true, [](A a, const char* css) {
                   return cell(duration_text(a.learning_s), a.learning_s, "", css);
                 }});
  return out;
}

std::string ranking_row(const std::vector<RankingColumn>& columns, const AlgorithmView& v) {
  std::string out = fmt::format("<tr class=\"{}\">", css_of(v)) + name_cell(v);
  for (const RankingColumn& column : columns)
    out += column.cell(*v.result, column.more ? "n more" : "n");
  return out + "</tr>\n";
}

std::string ranking_head(const std::vector<RankingColumn>& columns) {
  std::string out = "<thead><tr><th scope=\"col\">Algorithm</th>";
  for (const RankingColumn& column : columns)
    out += fmt::format("<th scope=\"col\"{}>{}</th>",
                       column.more ? " class=\"more\"" : "",
                       html_text(column.head));
  return out + "</tr></thead>\n<tbody>\n";
}

std::string joined(const std::vector<std::string>& all) {
  return fmt::format("{}", fmt::join(all, "; "));
}

}  // namespace

std::string ranking_table(const ReplayView& view) {
  const std::vector<RankingColumn> columns = ranking_columns(view);
  std::string out = "<div class=\"wide\"><table class=\"ranking\">\n" + ranking_head(columns);
  std::string bounds;
  for (const AlgorithmView* a : view.ranked)
    (a->result->bound ? bounds : out) += ranking_row(columns, *a);
  // Their own body, so that sorting keeps them apart from what one could use.
  if (!bounds.empty())
    out +=
        fmt::format(
            "</tbody>\n<tbody class=\"bounds\">\n<tr><th colspan=\"{}\">Bounds: they look at the "
            "reference of the run itself, and nobody could use them</th></tr>\n",
            columns.size() + 1) +
        bounds;
  return out + "</tbody></table></div>\n";
}

std::string needs_table(const ReplayView& view) {
  std::string out = "<div class=\"wide\"><table>\n" + table_head({"Algorithm",
                                                                  "What it is",
                                                                  "Needs",
                                                                  "A step costs",
                                                                  "A learning instant costs",
                                                                  "Source",
                                                                  "Here"});
  for (const AlgorithmView& v : view.algorithms) {
    const AlgorithmResult& a = *v.result;
    if (a.description == nullptr) continue;
    out += table_row({a.label,
                      std::string(a.description->title),
                      v.needs.empty() ? "nothing but the samples" : joined(v.needs),
                      std::string(a.description->complexity),
                      a.description->learning_complexity.empty()
                          ? "–"
                          : std::string(a.description->learning_complexity),
                      std::string(a.description->source),
                      a.ran ? "ran" : "skipped: " + a.why});
  }
  return out + "</tbody></table></div>\n";
}

namespace {

std::string input_row(const AlgorithmView& v, std::size_t j) {
  const AlgorithmResult& a = *v.result;
  const InputScore& input = a.inputs[j];
  const ErrorScore& e = input.error;
  const auto interval = [](const Interval& i) {
    return std::isfinite(i.low) ? interval_text(i, 3) : "";
  };
  return fmt::format("<tr class=\"{}\"><th scope=\"row\">{}</th>", css_of(v), html_text(a.label)) +
         cell(number_text(e.rmse), e.rmse, interval(e.rmse_ci95)) +
         cell(times_text(input.optimum_ratio), input.optimum_ratio) +
         cell(number_text(e.bias, 3), std::fabs(e.bias), interval(e.bias_ci95)) +
         cell(number_text(e.maximum, 3), e.maximum) +
         cell(duration_text(e.converged_s), e.converged_s) +
         cell(percent_text(e.availability, 4), e.availability) + "</tr>\n";
}

std::string input_table(const ReplayView& view, std::size_t j) {
  const InputResult& input = *view.inputs[j].result;
  const std::string unit = usual_unit(input.unit);
  std::string out = "<h3>Input " + html_text(input.name) + "</h3>\n<p class=\"note\">Optimum of " +
                    view.optimum + ": RMSE " + html_text(with_unit(input.optimum_rmse, 4, unit)) +
                    "</p>\n<div class=\"wide\"><table class=\"ranking\">\n" +
                    table_head({"Algorithm",
                                "RMSE" + (unit.empty() ? "" : ", " + unit),
                                "× best possible",
                                "Bias",
                                "Maximum",
                                "Converged",
                                "Available"});
  for (const AlgorithmView* a : view.inputs[j].ranked) out += input_row(*a, j);
  return out + "</tbody></table></div>\n";
}

}  // namespace

std::string inputs_table(const ReplayView& view) {
  if (view.inputs.size() < 2 || !view.result->has_reference) return "";
  std::string out;
  for (std::size_t j = 0; j < view.inputs.size(); ++j) out += input_table(view, j);
  return out;
}

std::string sensors_table(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::vector<std::string> head = {"Sensor"};
  if (r.has_reference)
    for (const char* name : {"RMSE", "95 %", "Bias", "Maximum"}) head.emplace_back(name);
  for (const char* name :
       {"Unit", "Noise given", "From", "Offset taken off", "Missing", "Row of H", ""})
    head.emplace_back(name);
  std::string out = "<div class=\"wide\"><table>\n" + table_head(head);
  for (std::size_t i = 0; i < r.sensors.size(); ++i) {
    const SensorResult& s = r.sensors[i];
    std::vector<std::string> row = {s.name};
    if (r.has_reference) {
      row.push_back(number_text(s.error.rmse));
      row.push_back(std::isfinite(s.error.rmse) ? interval_text(s.error.rmse_ci95) : "–");
      row.push_back(number_text(s.error.bias, 3));
      row.push_back(number_text(s.error.maximum, 3));
    }
    row.push_back(usual_unit(s.unit));
    row.push_back(view.noise_sd[i] ? number_text(*view.noise_sd[i], 4) : "not known");
    row.push_back(s.noise_source);
    row.push_back(s.offset == 0 ? "–" : number_text(s.offset, 4));
    row.push_back(s.missing > 0 ? percent_text(s.missing) : "none");
    std::string h;
    for (const double v : s.h) h += (h.empty() ? "" : ", ") + brief_text(v, 4);
    row.push_back(r.scene.tilt ? "–" : h);
    row.push_back(s.constant           ? "never changed"
                  : !s.copy_of.empty() ? "the same as " + s.copy_of
                                       : "");
    out += table_row(row);
  }
  return out + "</tbody></table></div>\n";
}

std::string blind_table(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (r.has_reference) return "";
  std::vector<std::string> head = {"Leave-one-out RMS of"};
  for (const SensorResult& s : r.sensors) head.push_back(s.name);
  std::string out =
      "<h3>Each sensor against the others</h3>\n<div class=\"wide\"><table>\n" + table_head(head);
  for (const AlgorithmView* one : view.ranked) {
    const AlgorithmResult& a = *one->result;
    if (!a.blind) continue;
    std::vector<std::string> row = {a.label};
    for (const double v : a.blind->leave_one_out) row.push_back(number_text(v));
    row.resize(head.size(), "–");
    out += table_row(row);
  }
  return out + "</tbody></table></div>\n";
}

std::string weights_table(const ReplayView& view) {
  if (view.final_rows.empty()) return "";
  std::vector<std::string> head = {"At the end of the run"};
  for (const SensorResult& s : view.result->sensors) head.push_back(s.name);
  head.emplace_back("Distance");
  std::string rows;
  for (const FinalRow& final : view.final_rows) {
    std::vector<std::string> row = {final.label};
    for (const double value : final.values) row.push_back(number_text(value, 4));
    row.resize(head.size() - 1, "–");
    row.push_back(number_text(final.distance, 3));
    rows += table_row(row);
  }
  return "<div class=\"copy-place\" data-copy=\"weights\"></div>\n<div "
         "class=\"wide\"><table>\n" +
         table_head(head) + rows +
         "</tbody></table></div>\n<p class=\"note\">Distance: of weights, root mean square over "
         "the run of "
         "their Euclidean distance from the optimal fixed weights; of standard deviations, root "
         "mean square "
         "of ln(variance / the sensor's mean square error).</p>\n";
}

namespace {

std::string answer_in_words(const FaultAnswer* answer) {
  if (answer == nullptr) return "–";
  if (!answer->found_s) return "missed";
  return (*answer->found_s == 0 ? "found at once"
                                : "found after " + duration_text(*answer->found_s)) +
         (answer->returned_s
              ? ", used again " + duration_text(*answer->returned_s) + " after its end"
              : "");
}

std::string fault_row(const ReplayView& view, std::size_t f) {
  const ReplayResult& r = *view.result;
  const SensorFault& fault = r.faults[f];
  const bool valueless = fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout;
  std::vector<std::string> row = {
      std::string(name_of(fault.kind)) + (valueless ? "" : " " + brief_text(fault.value, 4)),
      fault.sensor < r.sensors.size() ? r.sensors[fault.sensor].name : "–",
      instant_text(fault.from_s),
      std::isfinite(fault.to_s) ? instant_text(fault.to_s) : "the end"};
  for (const AlgorithmView* a : view.watching) row.push_back(answer_in_words(a->answers[f]));
  return table_row(row);
}

std::string alarms_row(const ReplayView& view) {
  std::vector<std::string> row = {"alarms where no fault is known", "", "", ""};
  for (const AlgorithmView* a : view.watching)
    row.push_back(count_text(a->alarms_without_fault) +
                  (a->result->faults_not_kept > 0
                       ? " (" + count_text(a->result->faults_not_kept) + " events not kept)"
                       : ""));
  return view.watching.empty() ? "" : table_row(row);
}

}  // namespace

std::string faults_table(const ReplayView& view) {
  const std::size_t known = view.result->faults.size();
  if (view.watching.empty() && known == 0) return "";
  std::vector<std::string> head = {"Known fault", "Sensor", "From", "To"};
  for (const AlgorithmView* a : view.watching) head.push_back(a->result->label);
  std::string out = "<div class=\"wide\"><table>\n" + table_head(head);
  for (std::size_t f = 0; f < std::min(known, kMostFaultRows); ++f) out += fault_row(view, f);
  return out + alarms_row(view) + "</tbody></table></div>\n" +
         (known > kMostFaultRows
              ? fmt::format("<p class=\"note\">The first {} of {}; all stand in report.json.</p>\n",
                            kMostFaultRows,
                            known)
              : "");
}

// Sensors that were never out need no row.
std::string out_share_table(const ReplayView& view) {
  const std::vector<SensorResult>& sensors = view.result->sensors;
  std::vector<std::string> head = {"Share of the run out"};
  for (const AlgorithmView* a : view.watching) head.push_back(a->result->label);
  std::string rows;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    std::vector<std::string> row = {sensors[i].name};
    bool ever = false;
    for (const AlgorithmView* a : view.watching) {
      const double share = i < a->out_share.size() ? a->out_share[i] : 0;
      ever = ever || share > 0;
      row.push_back(share > 0 ? percent_text(share) : "never");
    }
    if (ever) rows += table_row(row);
  }
  return rows.empty() ? ""
                      : "<div class=\"wide\"><table>\n" + table_head(head) + rows +
                            "</tbody></table></div>\n";
}

}  // namespace libchar
