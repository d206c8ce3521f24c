#pragma once
// What a replay found, for tests: an algorithm by its label, and all numbers as one text.

#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "libchar/replay/replay.hpp"
#include "libchar/replay/view/ranking.hpp"

namespace test {

using namespace libchar;

inline const AlgorithmResult& named(const ReplayResult& result, const std::string& label) {
  for (const AlgorithmResult& a : result.algorithms)
    if (a.label == label) return a;
  FAIL("no algorithm " << label);
  return result.algorithms[0];
}

// All sentences in a row.
inline std::string verdict_of(const ReplayResult& result, bool costs = true) {
  std::string out;
  for (const std::string& sentence : verdict_sentences(result, costs)) out += sentence + " ";
  return out;
}

// Everything but what a clock or the heap said.
inline std::string numbers(const ReplayResult& r) {
  std::string out;
  const auto add = [&](double v) { out += std::isnan(v) ? "nan " : std::to_string(v * 1e9) + " "; };
  const auto track = [&](const Timeline& t) {
    for (const double v : t.time_s) add(v);
    for (const auto& series : t.low)
      for (const double v : series) add(v);
  };
  for (const SensorResult& s : r.sensors) add(s.error.rmse);
  for (const InputResult& i : r.inputs) add(i.optimum_rmse);
  for (const AlgorithmResult& a : r.algorithms) {
    out += a.label + a.why + (a.as_good_as_best ? "*" : "");
    for (const double v :
         {a.rmse, a.rmse_ci95.low, a.rmse_ci95.high, a.regret, a.availability, a.weight_distance, a.variance_error})
      add(v);
    for (const InputScore& i : a.inputs) {
      add(i.error.bias);
      add(i.error.maximum);
      for (const AllanPoint& p : i.allan.points) add(p.deviation);
      track(i.window_rms);
    }
    for (const std::vector<double>& of_input : a.weights)
      for (const double weight : of_input) add(weight);
    for (const double variance : a.variances) add(variance);
    for (const FoundFault& f : a.faults) add(f.from_s);
    track(a.weight_track);
    track(a.variance_track);
  }
  return out;
}

}  // namespace test
