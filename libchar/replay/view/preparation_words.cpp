#include "libchar/replay/view/preparation_words.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/replay/detail/plan/band_filter.hpp"

namespace libchar {
namespace {

std::string with_unit(double value, int digits, const std::string& unit) {
  return brief_text(value, digits) + (unit.empty() ? "" : " " + unit);
}

std::string window_words(const TimeWindow& w) {
  return fmt::format("from {} to {} s", brief_text(w.from_s, 6), brief_text(w.to_s, 6));
}

std::string offset_words(const ReplayResult& r, const FoundOffset& offset) {
  const std::string& unit = r.inputs[0].unit;
  const std::string interval = std::isfinite(offset.ci95.low)
                                   ? fmt::format(" (95 %: {} to {})",
                                                 brief_text(offset.ci95.low, 4),
                                                 with_unit(offset.ci95.high, 4, unit))
                                   : "";
  std::string out = fmt::format(
      "The reference reads {}{} more than the sensors: found {}, {}, and subtracted from it. "
      "Errors "
      "do not hold this offset any more.",
      with_unit(offset.value, 4, unit),
      interval,
      offset.in_learning ? "in the learning window" : "on the evaluation itself",
      window_words(offset.window));
  if (offset.drifts) out += " The difference drifts: elsewhere it may be another.";
  return out;
}

}  // namespace

double settling_s(const ScenePreparation& p) {
  return p.filters() ? kSettlingPeriods / p.from_hz : 0;
}

std::vector<std::string> preparation_words(const Scene& scene) {
  const ScenePreparation& p = scene.preparation;
  const char* reference = scene.reference ? " and the reference" : "";
  std::vector<std::string> out;
  if (p.detrend != "none")
    out.push_back(
        fmt::format("From each sensor{} its own {} over the whole recording is subtracted.",
                    reference,
                    p.detrend == "mean" ? "mean" : "line of least squares"));
  if (!p.filters()) return out;
  const std::string band =
      p.to_hz > 0 ? fmt::format(" and a low-pass at {} Hz", brief_text(p.to_hz, 6)) : "";
  out.push_back(
      fmt::format("All sensors{} go through one filter: a Butterworth high-pass of second order at "
                  "{} Hz{}, causal. Its first {} are not learnt from and not scored; noise levels "
                  "are those behind it, and noise models are not used.",
                  reference,
                  brief_text(p.from_hz, 6),
                  band,
                  duration_text(settling_s(p))));
  return out;
}

std::vector<std::string> preparation_words(const ReplayResult& r) {
  std::vector<std::string> out = preparation_words(r.scene);
  if (r.reference_offset)
    out.push_back(offset_words(r, *r.reference_offset));
  else if (r.scene.reference && r.scene.reference->offset != 0)
    out.push_back(fmt::format("From the reference {} is subtracted.",
                              with_unit(r.scene.reference->offset, 6, r.inputs[0].unit)));
  return out;
}

}  // namespace libchar
