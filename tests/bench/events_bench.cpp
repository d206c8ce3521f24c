// Steps, warm-ups and ramps: false alarms on clean records, how often events are found, where they are placed and how large they are
// said to be, and K afterwards against the fit of the clean record. Usage: events_bench [records = 100]
//        events_bench FILE.npy RATE_HZ   prints what is found in each column of a recording
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>

#include "libchar/fit/events.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/npy.hpp"

namespace {

using namespace libchar;

constexpr double kRate = 100;
constexpr std::size_t kSamples = 200000;

struct Scene {
  std::string name;
  double q, b, k;
};
const std::vector<Scene> kScenes = {{"white", 5e-3, 0, 0},
                                    {"white, flicker", 5e-3, 5e-3, 0},
                                    {"white, flicker, walk", 5e-3, 5e-3, 1.5e-3},
                                    {"white, weak walk", 5e-3, 0, 1e-4},
                                    {"white, walk", 5e-3, 0, 2e-2},
                                    {"flicker", 1e-5, 5e-3, 0},
                                    {"walk alone", 0, 0, 1.5e-3}};

using Truth = std::function<void(std::vector<double>&, double sigma)>;

Truth step(double sigmas, double at) {
  return [=](std::vector<double>& y, double sigma) {
    for (std::size_t t = static_cast<std::size_t>(at * kRate); t < y.size(); ++t)
      y[t] += sigmas * sigma;
  };
}
Truth warm_up(double sigmas, double tau) {
  return [=](std::vector<double>& y, double sigma) {
    for (std::size_t t = 0; t < y.size(); ++t)
      y[t] += sigmas * sigma * std::exp(-static_cast<double>(t) / kRate / tau);
  };
}
Truth ramp(double sigmas) {
  return [=](std::vector<double>& y, double sigma) {
    for (std::size_t t = 0; t < y.size(); ++t)
      y[t] += sigmas * sigma * static_cast<double>(t) / static_cast<double>(y.size());
  };
}
struct Case {
  std::string name;
  Truth truth;
};
const std::vector<Case> kCases = {{"step .5 s", step(.5, 1000)},
                                  {"step 1 s", step(1, 740)},
                                  {"step 3 s", step(3, 300)},
                                  {"step 10 s", step(10, 1500)},
                                  {"warm-up 2 s, 140 s", warm_up(2, 140)},
                                  {"warm-up 3 s, 60 s", warm_up(3, 60)},
                                  {"warm-up 6 s, 140 s", warm_up(6, 140)},
                                  {"warm-up 6 s, 300 s", warm_up(6, 300)},
                                  {"ramp 5 s", ramp(5)},
                                  {"ramp 20 s", ramp(20)},
                                  {"ramp 50 s", ramp(50)}};

struct Tally {
  int records = 0, alarmed = 0;
  std::map<std::string, int> kinds;
  double ms = 0, off = 0, ratio = 0, score = 0;
};

void count(const EventSearch& found, Tally& tally) {
  ++tally.records;
  tally.alarmed += found.events.empty() ? 0 : 1;
  std::string names;
  for (const Event& event : found.events) {
    names += (names.empty() ? "" : "+") + std::string(event_name(event.kind));
    for (const EventKind other : event.not_told_from) names += "/" + std::string(event_name(other));
  }
  if (!names.empty()) ++tally.kinds[names];
  if (!found.events.empty()) {
    tally.score += found.events[0].score;
    tally.off = std::max(tally.off, found.events[0].at_s);
    tally.ratio += found.events[0].size;
  }
}

void print(const std::string& scene, const std::string& name, const Tally& tally) {
  std::string kinds;
  for (const auto& [kind, times] : tally.kinds) kinds += fmt::format(" {} {}", times, kind);
  fmt::print("{:22} {:20} {:4} of {:4}  score {:5.1f}  size {:.4f}  {:5.1f} ms {}\n",
             scene,
             name,
             tally.alarmed,
             tally.records,
             tally.score / std::max(1, tally.alarmed),
             tally.ratio / std::max(1, tally.alarmed),
             tally.ms / tally.records,
             kinds);
  std::fflush(stdout);
}

Tally run(
    const Scene& scene, const Truth& truth, int records, std::uint64_t seed, std::uint64_t points) {
  test::NoiseSource source(kSamples, kRate, seed);
  Tally tally;
  for (int r = 0; r < records; ++r) {
    std::vector<double> y = source.record(scene.q, scene.b, scene.k);
    if (truth) truth(y, scene.q * std::sqrt(kRate));
    const auto begin = std::chrono::steady_clock::now();
    const EventSearch found = find_events(event_series(y, kRate, points), fitted_powers());
    tally.ms +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    count(found, tally);
  }
  return tally;
}

void print_recording(const std::string& path, double rate_hz) {
  const test::Array array = test::npy(path);
  for (std::size_t c = 0; c < array.columns; ++c) {
    const EventSearch found = find_events(event_series(array.column(c), rate_hz), fitted_powers());
    fmt::print("column {}: {} events{}\n", c, found.events.size(), found.more ? " and more" : "");
    for (std::size_t i = 0; i < found.events.size(); ++i)
      fmt::print("   {} score {:.1f} (threshold {:.1f})\n",
                 found.sentences[i],
                 found.events[i].score,
                 found.events[i].threshold);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 && std::string(argv[1]).ends_with(".npy")) {
    print_recording(argv[1], std::atof(argv[2]));
    return 0;
  }
  const int records = argc > 1 ? std::atoi(argv[1]) : 100;
  const std::uint64_t points = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1U << 15U;
  for (const Scene& scene : kScenes) print(scene.name, "clean", run(scene, {}, records, 1, points));
  for (const Case& one : kCases)
    print(kScenes[2].name, one.name, run(kScenes[2], one.truth, records / 4 + 1, 7, points));
  return 0;
}
