#include "libchar/report/detail/replay_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/units.hpp"
#include "libchar/replay/view/words.hpp"

namespace libchar {

std::string score_name(const ReplayResult& result) {
  return result.has_reference ? "RMSE" : "Leave-one-out RMS";
}

std::string usual_unit(const std::string& unit) {
  const auto known = find_unit(unit);
  return known && known->symbol != "1" ? std::string(known->symbol) : unit;
}

std::string score_unit(const ReplayResult& result) {
  return result.inputs.empty() ? "" : usual_unit(result.inputs[0].unit);
}

std::string with_unit(double value, int digits, const std::string& unit) {
  const std::string number = number_text(value, digits);
  return unit.empty() || !std::isfinite(value) ? number : number + " " + unit;
}

std::string instant_text(double seconds) {
  return std::isfinite(seconds) ? brief_text(seconds, 8) + " s" : "–";
}

std::string stretch_text(double from_s, double to_s) {
  return instant_text(from_s) + " … " + (std::isfinite(to_s) ? instant_text(to_s) : "the end");
}

std::vector<std::string> run_facts(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  std::vector<std::string> out = {fmt::format("{} sensors, {} instants at {} Hz from {}, {}.",
                                              r.sensors.size(),
                                              r.instants,
                                              brief_text(r.rate_hz, 6),
                                              instant_text(r.start_s),
                                              duration_text(view.duration_s))};
  out.push_back(r.has_reference ? "Reference: " + r.reference_use + "." : "No reference.");
  for (const InputResult& input : r.inputs)
    if (r.has_reference && std::isfinite(input.optimum_rmse))
      out.push_back(fmt::format("Optimum of {}{}: RMSE {}.",
                                view.optimum,
                                r.inputs.size() > 1 ? " for " + input.name : "",
                                with_unit(input.optimum_rmse, 4, usual_unit(input.unit))));
  if (r.lag_estimated)
    out.push_back(
        fmt::format("The sensors lag the reference by {} (estimated).", duration_text(r.lag_s)));
  for (std::string& sentence : preparation_words(r)) out.push_back(std::move(sentence));
  return out;
}

std::vector<std::string> skipped_words(const ReplayView& view) {
  std::vector<std::string> out;
  for (const SkippedAlgorithms& s : view.skipped)
    out.push_back(fmt::format("{}: {}", fmt::join(s.labels, ", "), s.reason));
  return out;
}

std::vector<std::string> remark_words(const ReplayView& view) {
  std::vector<std::string> out;
  for (const AlgorithmRemark& remark : view.remarks)
    out.push_back((remark.label.empty() ? "" : remark.label + ": ") + remark.message +
                  (remark.count > 1 ? fmt::format(" ({} ×)", remark.count) : ""));
  return out;
}

}  // namespace libchar
