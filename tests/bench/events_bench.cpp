// Steps, warm-ups and ramps: false alarms on clean records, how often events are found, where they are placed and how
// large they are said to be, and K afterwards against the fit of the clean record. Usage: events_bench [records = 100]
//        events_bench FILE.npy RATE_HZ   prints what is found in each column of a recording,
//                                        motion and digital faults as well
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>

#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/signs/digital.hpp"
#include "libchar/fit/signs/events.hpp"
#include "libchar/fit/signs/motion.hpp"
#include "tests/support/digital.hpp"
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
    for (std::size_t t = static_cast<std::size_t>(at * kRate); t < y.size(); ++t) y[t] += sigmas * sigma;
  };
}
Truth warm_up(double sigmas, double tau) {
  return [=](std::vector<double>& y, double sigma) {
    for (std::size_t t = 0; t < y.size(); ++t) y[t] += sigmas * sigma * std::exp(-static_cast<double>(t) / kRate / tau);
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
  double at_s = 0;
};
const std::vector<Case> kCases = {{"step .5 sd", step(.5, 1000), 1000},
                                  {"step 1 sd", step(1, 740), 740},
                                  {"step 3 sd", step(3, 300), 300},
                                  {"step 10 sd", step(10, 1500), 1500},
                                  {"warm-up 2 sd, 140 s", warm_up(2, 140)},
                                  {"warm-up 3 sd, 60 s", warm_up(3, 60)},
                                  {"warm-up 6 sd, 140 s", warm_up(6, 140)},
                                  {"warm-up 6 sd, 300 s", warm_up(6, 300)},
                                  {"ramp 5 sd", ramp(5)},
                                  {"ramp 20 sd", ramp(20)},
                                  {"ramp 50 sd", ramp(50)}};

struct Tally {
  double untreated = 0;  ///< K with the event in the record, over the truth, summed
  int records = 0, alarmed = 0;
  std::map<std::string, int> kinds;
  double ms = 0, size = 0, score = 0, furthest_s = 0;
  double clean2 = 0, after2 = 0,
         moved2 = 0;  ///< squares: K of the clean record and afterwards less the truth, and their difference
};

void count(const EventSearch& found, Tally& tally) {
  ++tally.records;
  if (found.events.empty()) return;
  ++tally.alarmed;
  std::string names;
  for (const Event& event : found.events) {
    names += (names.empty() ? "" : "+") + std::string(event_name(event.kind));
    for (const EventKind other : event.not_told_from) names += "/" + std::string(event_name(other));
  }
  ++tally.kinds[names];
  tally.score += found.events[0].score;
  tally.size += found.events[0].size;
}

double walk_of(std::span<const double> record) {
  FitOptions options;
  options.remedies = options.second_opinion = false;
  return std::sqrt(fit_record(record, kRate, nullptr, options).theta[2]);
}

void print(const std::string& scene, const std::string& name, const Tally& tally) {
  std::string kinds;
  for (const auto& [kind, times] : tally.kinds) kinds += fmt::format(" {} {}", times, kind);
  const double count = tally.records, found = std::max(1, tally.alarmed);
  fmt::print("{:21} {:19} {:4} of {:4}  score {:4.1f} size {:7.4f} off {:4.2f} s", scene, name, tally.alarmed,
             tally.records, tally.score / found, tally.size / found, tally.furthest_s);
  if (tally.clean2 > 0)
    fmt::print("  K: untreated x {:.2f}, then rms error {:.2f} of the clean fit's, moved by {:.2f} of it",
               tally.untreated / count, std::sqrt(tally.after2 / tally.clean2), std::sqrt(tally.moved2 / tally.clean2));
  fmt::print("  {:.1f} ms {}\n", tally.ms / count, kinds);
  std::fflush(stdout);
}

Tally run(const Scene& scene, const Case& one, int records, std::uint64_t seed, std::uint64_t points) {
  test::NoiseSource source(kSamples, kRate, seed);
  Tally tally;
  for (int r = 0; r < records; ++r) {
    std::vector<double> y = source.record(scene.q, scene.b, scene.k);
    const double clean = one.truth ? walk_of(y) - scene.k : 0;
    if (one.truth) {
      one.truth(y, scene.q * std::sqrt(kRate));
      tally.untreated += walk_of(y) / scene.k;
    }
    const auto begin = std::chrono::steady_clock::now();
    const EventSearch found = find_events(event_series(y, kRate, points), fitted_powers());
    const auto end = std::chrono::steady_clock::now();
    tally.ms += std::chrono::duration<double, std::milli>(end - begin).count();
    count(found, tally);
    if (!one.truth) continue;
    for (const Event& event : found.events)
      if (event.kind == EventKind::step) tally.furthest_s = std::max(tally.furthest_s, std::abs(event.at_s - one.at_s));
    subtract_events(found.events, kRate, y);
    const double after = walk_of(y) - scene.k;
    tally.clean2 += clean * clean;
    tally.after2 += after * after;
    tally.moved2 += (after - clean) * (after - clean);
  }
  return tally;
}

void print_recording(const std::string& path, double rate_hz) {
  const test::Array array = test::npy(path);
  for (std::size_t c = 0; c < array.columns; ++c) {
    const std::vector<double> record = array.column(c);
    const EventSeries series = event_series(record, rate_hz);
    const Motion motion = find_motion(series);
    fmt::print("column {}:\n", c);
    for (const Finding& one : motion.findings) fmt::print("   {}\n", one.sentence);
    for (const Finding& one : test::digital_faults(record, rate_hz).findings) fmt::print("   {}\n", one.sentence);
    if (motion.whole) continue;
    for (const Finding& one : find_events(series, fitted_powers()).findings) fmt::print("   {}\n", one.sentence);
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
  for (const Case& one : kCases) print(kScenes[2].name, one.name, run(kScenes[2], one, records / 2 + 1, 7, points));
  return 0;
}
