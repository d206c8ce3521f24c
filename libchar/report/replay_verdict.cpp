// The answer of a replay in sentences. Rules: bounds are never recommended; a method that learns
// from a reference is named as such, with the best one that does not; differences that the interval
// of the ratio does not resolve are said to be unresolved, with the cheapest of those methods.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/report/people.hpp"
#include "libchar/report/replay_words.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostNames = 5;

std::string names(const std::vector<std::string>& all) {
  std::string out;
  for (std::size_t i = 0; i < std::min(all.size(), kMostNames); ++i)
    out += (i == 0                                            ? ""
            : i + 1 == all.size() && all.size() <= kMostNames ? " and "
                                                              : ", ") +
           all[i];
  if (all.size() > kMostNames) out += fmt::format(" and {} more", all.size() - kMostNames);
  return out;
}

std::string cost(const AlgorithmResult& a) {
  std::string out;
  if (std::isfinite(a.ns_per_sample))
    out += ", " + people_nanoseconds(a.ns_per_sample) + " a sample";
  if (a.peak_bytes) out += ", " + people_bytes(static_cast<double>(*a.peak_bytes)) + " of memory";
  return out;
}

bool taught(const AlgorithmResult& a) {
  return a.card != nullptr && a.card->needs.reference;
}

// "RMSE 0.0331 rad/s (95 %: 0.0329 … 0.0333), 0.10 % above the optimum of this scene"
std::string figures(const ReplayResult& r, const AlgorithmResult& a) {
  std::string out = fmt::format("{} {}", score_name(r), with_unit(a.rmse, 4, score_unit(r)));
  if (std::isfinite(a.rmse_ci95.low)) out += " (95 %: " + people_interval(a.rmse_ci95) + ")";
  for (std::size_t j = 1; j < a.inputs.size(); ++j)
    out += fmt::format(
        ", {} {}",
        j < r.inputs.size() ? r.inputs[j].name : "",
        with_unit(
            a.inputs[j].error.rmse, 4, j < r.inputs.size() ? usual_unit(r.inputs[j].unit) : ""));
  if (std::isfinite(a.regret))
    out += a.regret >= 0
               ? fmt::format(", {} above the optimum of this scene", people_percent(a.regret))
               : fmt::format(", {} below what the best fixed weights reach in this scene",
                             people_percent(-a.regret));
  return out;
}

std::string recommendation(const ReplayResult& r, const AlgorithmResult& a, bool measured) {
  std::string out = fmt::format("Use {}: {}{}.", a.label, figures(r, a), measured ? cost(a) : "");
  if (a.availability < 0.9995)
    out +=
        fmt::format(" It has an estimate at {} of the instants.", people_percent(a.availability));
  return out;
}

// Who is as good, as far as this recording tells.
void unresolved(const ReplayResult& r, bool measured, std::vector<std::string>& out) {
  std::vector<std::string> labels;
  const AlgorithmResult& best = r.algorithms[*r.best];
  const AlgorithmResult* cheapest = &best;
  for (const std::size_t i : ranked(r)) {
    const AlgorithmResult& a = r.algorithms[i];
    if (i == *r.best || a.bound || !a.as_good_as_best) continue;
    labels.push_back(a.label + (taught(a) ? " (learns from a reference)" : ""));
    if (a.ns_per_sample < cheapest->ns_per_sample) cheapest = &a;
  }
  if (labels.empty()) {
    out.push_back("Every other method is worse by more than chance (95 %).");
    return;
  }
  out.push_back(fmt::format("Not resolved from it by this run: {}.", names(labels)));
  if (measured && cheapest != &best && cheapest->ns_per_sample < 0.8 * best.ns_per_sample)
    out.back() += fmt::format(" The cheapest of them is {}{}.", cheapest->label, cost(*cheapest));
}

// What is left to those who have no reference to learn from.
void without_teacher(const ReplayResult& r, bool measured, std::vector<std::string>& out) {
  const AlgorithmResult& best = r.algorithms[*r.best];
  if (!taught(best)) return;
  out.push_back(fmt::format(
      "{} learns from a reference before the run{}.",
      best.label,
      r.learning ? " (here " + people_stretch(r.learning->from_s, r.learning->to_s) + ")" : ""));
  for (const std::size_t i : ranked(r)) {
    const AlgorithmResult& a = r.algorithms[i];
    if (a.bound || taught(a) || !std::isfinite(a.rmse)) continue;
    out.back() += fmt::format(
        " Without one, the best is {}: {}{}.", a.label, figures(r, a), measured ? cost(a) : "");
    return;
  }
}

void bounds(const ReplayResult& r, std::vector<std::string>& out) {
  std::vector<std::string> labels;
  for (const std::size_t i : ranked(r))
    if (r.algorithms[i].bound && std::isfinite(r.algorithms[i].rmse))
      labels.push_back(fmt::format(
          "{} {}", r.algorithms[i].label, with_unit(r.algorithms[i].rmse, 4, score_unit(r))));
  if (!labels.empty())
    out.push_back(fmt::format("For comparison, bounds that look at the reference of the run: {}.",
                              names(labels)));
}

}  // namespace

std::vector<std::string> replay_verdict(const ReplayResult& r, bool measured) {
  if (!r.best || *r.best >= r.algorithms.size())
    return {"No method gave an estimate that can be scored."};
  std::vector<std::string> out = {recommendation(r, r.algorithms[*r.best], measured)};
  without_teacher(r, measured, out);
  unresolved(r, measured, out);
  if (r.has_reference)
    bounds(r, out);
  else
    out.push_back(
        "There is no reference: the scores say how well sensors predict each other, and errors "
        "that all "
        "sensors share are not seen.");
  return out;
}

}  // namespace libchar
