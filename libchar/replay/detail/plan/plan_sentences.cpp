#include "libchar/replay/detail/plan/plan_sentences.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/view/words.hpp"

namespace libchar {
namespace {

std::string seconds(double s) { return brief_text(s, 6) + " s"; }

std::string names_of(const std::vector<PlannedAlgorithm>& algorithms, auto&& wanted) {
  std::string out;
  for (const PlannedAlgorithm& a : algorithms)
    if (a.asked && a.runs() && wanted(a)) out += (out.empty() ? "" : ", ") + a.label;
  return out;
}

std::string reading(const Scene& scene, const Instants& instants) {
  const SourceInfo& source = instants.source().info();
  if (scene.simulate)
    return fmt::format("simulates {} sensors, {} samples at {}, seed {}, again for each pass", scene.sensors.size(),
                       source.samples, detail::frequency_text(source.rate_hz, 6), scene.simulate->seed);
  return fmt::format("reads {} of {}: {} samples at {}, {}",
                     plural(source.units.size() + source.reference_units.size(), "channel"), source.logs[0].file,
                     source.samples, detail::frequency_text(source.rate_hz, 6),
                     source.kept ? "once, and keeps them" : "again for each pass");
}

// Of sensors whose unit is not that of the others; "": all are in one.
std::string conversions(const Scene& scene, const Instants& instants) {
  std::string out, common;
  for (std::size_t i = 0; !scene.tilt && i < scene.sensors.size(); ++i)
    if (instants.factor(i) != 1) {
      common = instants.info().units[i];
      out += fmt::format("{}{} from {}", out.empty() ? "" : ", ", scene.sensors[i].name,
                         scene.sensors[i].unit.empty() ? instants.source().info().units[i] : scene.sensors[i].unit);
    }
  return out.empty() ? out : "converts to " + common + ": " + out;
}

std::string reference(const Scene& scene, const Instants& instants) {
  if (!scene.reference) return "no reference: no algorithm learns, scores are leave-one-out and split-array";
  std::string names;
  for (const std::string& name : scene.reference->channels) names += (names.empty() ? "" : ", ") + name;
  return fmt::format("reference {}: {}", names, instants.info().reference_use);
}

std::string learning(const ReplayPlan& plan, bool said) {
  if (plan.learn_to <= plan.learn_from) return "no learning window: nothing is learnt beforehand";
  if (!plan.learning_pass) return "the learning window is not read: no algorithm that runs learns there";
  return fmt::format("learning on {} instants from {} to {}{}: {}", plan.learn_to - plan.learn_from,
                     seconds(plan.learning.from_s), seconds(plan.learning.to_s),
                     said ? "" : ", the first half, as no window is given (`learning`)",
                     names_of(plan.algorithms, [](const auto& a) { return a.learns_before(); }));
}

std::string levels(const Scene& scene, const SensorKnowledge& knowledge) {
  std::string out;
  for (std::size_t i = 0; i < scene.sensors.size(); ++i)
    if (knowledge.noise_sources[i].empty()) out += (out.empty() ? "" : ", ") + scene.sensors[i].name;
  if (!out.empty()) return "noise levels: not known of " + out;
  auto sources = knowledge.noise_sources;
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  return fmt::format("noise levels: from {}", fmt::join(sources, " and "));
}

std::string optimum(const ReplayPlan& plan) {
  if (plan.optimum.empty()) return "";
  return plan.array.tilt ? "optimum: the best filter tuned on the evaluation itself"
                         : fmt::format("optimum: best fixed weights learnt on the evaluation itself{}",
                                       plan.array.section_starts.empty() ? "" : ", failed sensors left out");
}

std::string align(const SceneAlign& align) {
  std::string where = "in the learning window";
  if (align.window) {
    const double to_s = align.window->to_s;
    where =
        fmt::format("from {} to {}", seconds(align.window->from_s), std::isfinite(to_s) ? seconds(to_s) : "the end");
  } else if (align.learn == "run") {
    where = "on the evaluation itself";
  } else if (align.learn == "rest") {
    where = "at rest";
  }
  if (align.choose)
    return fmt::format(
        "alignment: terms are tried one by one {}, and taken out of the sensors where they pay on the other half of it",
        where);
  return fmt::format("alignment: learnt {}{}", where,
                     align.apply ? ", taken out of the sensors before they are fused"
                                 : "; reported only, the sensors are fused as recorded");
}

}  // namespace

std::string blind_share_text(const PlannedAlgorithm& algorithm) {
  const BlindShare& share = algorithm.blind;
  return fmt::format("{}: {}, all of it would take about {}", algorithm.label,
                     share.stretches.empty() ? std::string("left out")
                                             : fmt::format("on {} stretches, {} of the evaluation",
                                                           share.stretches.size(), percent_text(share.share)),
                     duration_text(share.cost_s, 2));
}

std::vector<std::string> sentences(const ReplayPlan& plan, const Scene& scene, const Instants& instants,
                                   const SensorKnowledge& knowledge) {
  std::vector<std::string> out = {reading(scene, instants), reference(scene, instants)};
  if (std::string text = conversions(scene, instants); !text.empty()) out.push_back(std::move(text));
  if (!scene.tilt) out.push_back(levels(scene, knowledge));
  if (scene.rest)
    out.push_back(fmt::format("at rest from {} to {}: offsets subtracted", seconds(scene.rest->from_s),
                              seconds(scene.rest->to_s)));
  for (std::string& sentence : preparation_words(scene)) out.push_back(std::move(sentence));
  if (scene.reference && scene.reference->estimate_offset)
    out.push_back(fmt::format("offset of the reference: found {}, subtracted from it",
                              plan.learn_to > plan.learn_from ? "in the learning window" : "on the evaluation itself"));
  if (scene.align) out.push_back(align(*scene.align));
  if (scene.reference) out.push_back(learning(plan, scene.learning || !scene.align || !scene.align->choose));
  out.push_back(fmt::format("evaluation: {} instants at {} from {} to {}", plan.run_to - plan.run_from,
                            detail::frequency_text(instants.info().rate_hz, 6), seconds(plan.evaluation.from_s),
                            seconds(plan.evaluation.to_s)));
  if (plan.warm_up > 0)
    out.push_back(fmt::format("warm-up: the first {} of it are run and not scored",
                              seconds(static_cast<double>(plan.warm_up) / instants.info().rate_hz)));
  if (plan.array.fault_free_samples > 0)
    out.push_back(fmt::format("no sensor fails in the first {} of it",
                              seconds(static_cast<double>(plan.array.fault_free_samples) / instants.info().rate_hz)));
  if (const std::string text = optimum(plan); !text.empty()) out.push_back(text);
  if (plan.looking_pass)
    out.push_back("looks at the whole evaluation before it estimates: " +
                  names_of(plan.algorithms, [](const auto& a) { return a.looks_ahead(); }));
  out.push_back("runs " + names_of(plan.algorithms, [](const auto&) { return true; }));
  for (const PlannedAlgorithm& a : plan.algorithms)
    if (a.asked && a.runs() && !a.blind.whole && !scene.reference)
      out.push_back("leave-one-out of " + blind_share_text(a) + " (`budget_s`)");
  for (const PlannedAlgorithm& a : plan.algorithms)
    if (a.asked && !a.runs()) out.push_back("skips " + a.label + ": " + a.why);
  return out;
}

}  // namespace libchar
