// Runs of one sensor in one likelihood: how often intervals cover, how often equal runs are called unlike, unlike ones
// found and named, and what the spread of the turn-on bias says. Usage: runs_bench [sets = 100]
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "libchar/characterize/compare/runs.hpp"
#include "tests/support/noise.hpp"

namespace {

using namespace libchar;

constexpr double kRate = 100;
constexpr std::size_t kRuns = 12, kSamples = 5200;

struct Coefficients3 {
  double q = 5e-3, b = 5e-3, k = 1.5e-3;
};

struct Scene {
  std::string name;
  Coefficients3 truth;
  double turn_on = 0;    ///< standard deviation of the bias
  Coefficients3 odd;     ///< of the last run
  bool unequal = false;  ///< every other run three times as long
};

Characterization characterized(std::vector<double> samples, std::size_t run) {
  Recording recording;
  recording.info.file = "run" + std::to_string(run);
  recording.info.channels = {{"x", "deg/s"}};
  recording.info.time.rate_hz = kRate;
  recording.samples = {std::move(samples)};
  CharacterizeOptions options;
  options.wanted.spectrum = false;
  options.fit.second_opinion = false;
  return characterize(recording, options);
}

std::vector<Characterization> runs_of(const Scene& scene, std::uint64_t seed) {
  test::NoiseSource usual(kSamples, kRate, seed), longer(3 * kSamples, kRate, seed + 7777);
  std::vector<Characterization> out;
  for (std::size_t r = 0; r < kRuns; ++r) {
    const Coefficients3& c = r + 1 == kRuns ? scene.odd : scene.truth;
    test::NoiseSource& source = scene.unequal && r % 2 == 1 ? longer : usual;
    std::vector<double> samples = source.record(c.q, c.b, c.k);
    const double bias = scene.turn_on * usual.gauss()();
    for (double& value : samples) value += bias;
    out.push_back(characterized(std::move(samples), r));
  }
  return out;
}

struct Tally {
  int covered[3] = {}, limited[3] = {};  ///< by an interval or a limit; of these by a limit alone
  int unlike = 0, named = 0, wrongly_named = 0, spread_found = 0, spread_covered = 0, shaped = 0;
  double milliseconds = 0;
};

void count_terms(const Scene& scene, const NoiseFit& fit, Tally& tally) {
  const double truth[3] = {scene.truth.q, scene.truth.b, scene.truth.k};
  for (std::size_t t = 0; t < 3; ++t) {
    const Coefficient& c = fit.term[t];
    const bool holds = c.value ? c.ci95.low <= truth[t] && truth[t] <= c.ci95.high : c.upper95.value_or(0) >= truth[t];
    tally.covered[t] += holds ? 1 : 0;
    tally.limited[t] += c.value ? 0 : 1;
  }
  tally.shaped += fit.shape.kind != NoiseShape::Kind::none ? 1 : 0;
}

void count_set(const Scene& scene, std::uint64_t seed, Tally& tally) {
  const std::vector<Characterization> runs = runs_of(scene, seed);
  const auto start = std::chrono::steady_clock::now();
  const PooledRuns pooled = pool_runs(runs);
  tally.milliseconds += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const PooledChannel& c = pooled.channels.at(0);
  count_terms(scene, c.fit, tally);
  tally.unlike += c.consistent ? 0 : 1;
  for (const ChannelRun& run : c.runs)
    (run.run + 1 == kRuns ? tally.named : tally.wrongly_named) += run.differs ? 1 : 0;
  if (!c.bias) return;
  tally.spread_found += c.bias->spread_ci95.low > 0 ? 1 : 0;
  tally.spread_covered += c.bias->spread_ci95.low <= scene.turn_on && scene.turn_on <= c.bias->spread_ci95.high ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int sets = argc > 1 ? std::atoi(argv[1]) : 100;
  const Coefficients3 usual;
  const std::vector<Scene> scenes = {{"equal", usual, 0, usual, false},
                                     {"white alone", {5e-3, 0, 0}, 0, {5e-3, 0, 0}, false},
                                     {"unequal lengths", usual, 0, usual, true},
                                     {"turn-on .05", usual, 0.05, usual, false},
                                     {"last run Q x 1.1", usual, 0, {5.5e-3, 5e-3, 1.5e-3}, false},
                                     {"last run B x 2", usual, 0, {5e-3, 1e-2, 1.5e-3}, false},
                                     {"last run K x 4", usual, 0, {5e-3, 5e-3, 6e-3}, false}};
  fmt::print("{} sets of {} runs of {} samples at {} Hz\n", sets, kRuns, kSamples, kRate);
  fmt::print(
      "| scene | covers N, B, K | limits alone | called unlike | named: the odd one, others | spread > 0 | its "
      "interval covers | shape | ms |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const Scene& scene : scenes) {
    Tally t;
    for (int s = 0; s < sets; ++s) count_set(scene, 1000 + static_cast<std::uint64_t>(s), t);
    fmt::print("| {} | {}, {}, {} | {}, {}, {} | {} | {}, {} | {} | {} | {} | {:.0f} |\n", scene.name, t.covered[0],
               t.covered[1], t.covered[2], t.limited[0], t.limited[1], t.limited[2], t.unlike, t.named, t.wrongly_named,
               t.spread_found, t.spread_covered, t.shaped, t.milliseconds / sets);
  }
  fmt::print("A misfit (unlike runs) has widened intervals.\n");
  return 0;
}
