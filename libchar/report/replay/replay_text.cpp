#include "libchar/report/replay/replay_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/view/algorithm_words.hpp"
#include "libchar/replay/view/preparation_words.hpp"
#include "libchar/report/detail/html/alignment_pieces.hpp"

namespace libchar {
namespace {}  // namespace

std::string replay_text(const ReplayView& view, std::size_t width) {
  const ReplayResult& r = *view.result;
  const std::string unit = r.inputs[0].unit.empty() ? "" : " " + r.inputs[0].unit;
  const char* error = r.has_reference ? "RMSE" : "leave-one-out";
  std::string text = fmt::format("{}: {} sensors, {} instants at {} Hz\n",
                                 printable(view.title),
                                 r.sensors.size(),
                                 r.instants,
                                 brief_text(r.rate_hz, 6));
  if (r.lag_estimated)
    text +=
        fmt::format("the sensors lag the reference by {} (estimated)\n", duration_text(r.lag_s));
  for (const std::string& sentence : preparation_words(r)) text += printable(sentence) + "\n";
  if (r.has_reference && std::isfinite(r.inputs[0].optimum_rmse))
    text += fmt::format(
        "optimum of this scene: RMSE {}{}\n", brief_text(r.inputs[0].optimum_rmse, 4), unit);
  std::vector<std::vector<std::string>> rows = {
      {"algorithm", error, "95 %", "regret", "ns/sample", "memory", ""}};
  for (const AlgorithmView* v : view.ranked) {
    const AlgorithmResult* a = v->result;
    rows.push_back({printable(a->label),
                    number_text(a->rmse),
                    interval_text(a->rmse_ci95),
                    excess_text(a->regret),
                    brief_text(a->ns_per_sample, 3),
                    bytes_text(a->peak_bytes),
                    a->bound             ? "(bound)"
                    : a->as_good_as_best ? "*"
                                         : ""});
  }
  text += "\n" + text_table(rows, "", true, width);
  text += "\n* the best method, and those whose difference from it is not resolved\n";
  for (const SkippedAlgorithms& s : view.skipped)
    text += fmt::format("skipped {}: {}\n",
                        printable(fmt::format("{}", fmt::join(s.labels, ", "))),
                        printable(s.reason));
  text += alignment_text(view);
  text += "\n" + printable(fmt::format("{}", fmt::join(view.shown_verdict, " "))) + "\n";
  return text;
}

namespace {

std::string option_text(const fusion::Option& option) {
  return fmt::format("{:<28}   {} = {}{}  {}\n",
                     "",
                     option.name,
                     brief_text(option.standard, 6),
                     option.unit.empty() ? "" : " " + std::string(option.unit),
                     option.meaning);
}

}  // namespace

std::string algorithms_text() {
  std::string text;
  std::vector<std::string_view> watched;
  std::span<const fusion::Option> watching;
  for (const fusion::Entry& entry : fusion::algorithms()) {
    if (entry.own_options < entry.options.size()) {
      watched.push_back(entry.description->name);
      watching = entry.options.subspan(entry.own_options);
    }
    text += fmt::format("{:<28} {}\n", entry.description->name, entry.description->title);
    for (const std::string& need : needs_in_words(*entry.description))
      text += fmt::format("{:<28}   needs {}\n", "", need);
    for (const fusion::Option& option : entry.options.first(entry.own_options))
      text += option_text(option);
  }
  if (watched.empty()) return text;
  text += fmt::format("\n  beside their own options {} have\n", fmt::join(watched, ", "));
  for (const fusion::Option& option : watching) text += option_text(option);
  return text;
}

}  // namespace libchar
