// The fault detector of `minque` at its limit: six gyroscopes of [RV 5.1] at 200 Hz (docs/theory/fusion.md).
//
//   fault_bench delays [TRIALS]    mean delay, detections, isolation, kinds for each fault, sensors 1, 3, 6
//   fault_bench clean [SAMPLES]    false alarms on fault-free samples, plain and with drift, gains, delays
//   fault_bench recovery           time until a sensor is in again; early returns within 150 s
//   fault_bench sets [TRIALS]      pairs, triples, three against three
//   fault_bench matrix [TRIALS]    two inputs, eight sensors
//   fault_bench speed              nanoseconds a step

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "libchar/fusion/algorithms/minque.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

constexpr double kRate = 200;

/// Flicker of coefficient B as a sum of held first-order processes, one an octave: B^2 ln 2 / pi each.
class Flicker {
 public:
  double step(double b, std::int64_t k, test::Gaussian& gauss) {
    double sum = 0;
    for (std::size_t j = 0; j < kOctaves; ++j) {
      if (k % (std::int64_t{1} << j) == 0) state_[j] = 0.5 * state_[j] + std::sqrt(0.75) * gauss();
      sum += state_[j];
    }
    return sum * b * std::sqrt(std::numbers::ln2 / std::numbers::pi);
  }

 private:
  static constexpr std::size_t kOctaves = 16;
  double state_[kOctaves] = {};
};

struct Wrongs {
  double flicker = 8e-4;  ///< B, rad/s
  double walk = 0;        ///< K, rad/s/sqrt(s)
  double gain = 0;        ///< deviation of the gains
  double delay = 0;       ///< largest delay, samples
};

/// Six gyroscopes that see a sine of 7.854 rad/s at 5 Hz.
class Gyroscopes {
 public:
  static constexpr int kSensors = 6;
  explicit Gyroscopes(std::uint64_t seed, const Wrongs& wrongs = {}) : wrongs_(wrongs), gauss_(seed) {
    for (int i = 0; i < kSensors; ++i) {
      deviation_[i] = std::sqrt(304.2) * 1e-3 * (3 + i);
      gain_[i] = 1 + wrongs.gain * gauss_();
      delay_[i] = wrongs.delay * (2 * gauss_.uniform() - 1);
    }
  }
  double truth(double back = 0) const {
    return 7.854 * std::sin(2 * std::numbers::pi * 5 * (static_cast<double>(k_) - back) / kRate + .785);
  }
  void next(double* y) {
    ++k_;
    for (int i = 0; i < kSensors; ++i) {
      walk_[i] += wrongs_.walk > 0 ? wrongs_.walk / std::sqrt(kRate) * gauss_() : 0;
      y[i] = gain_[i] * truth(delay_[i]) + deviation_[i] * noise[i] * gauss_() +
             flicker_[i].step(wrongs_.flicker, k_, gauss_) + walk_[i];
    }
  }
  double deviation(int i) const { return deviation_[i]; }
  double noise[kSensors] = {1, 1, 1, 1, 1, 1};  ///< times the deviation

 private:
  Wrongs wrongs_;
  test::Gaussian gauss_;
  std::int64_t k_ = -1;
  double deviation_[kSensors] = {}, gain_[kSensors] = {}, delay_[kSensors] = {}, walk_[kSensors] = {};
  Flicker flicker_[kSensors];
};

struct Fault {
  std::string name;
  std::function<double(double y, double t)> how;  ///< t: seconds since the fault
  double noise = 1;
};

std::vector<Fault> faults_of_interest() {
  const auto gain = [](double g) { return [g](double y, double) { return y * g; }; };
  const auto bias = [](double b) { return [b](double y, double) { return y + b; }; };
  const auto same = [](double y, double) { return y; };
  return {{"gain -1 %", gain(.99)},
          {"gain -2 %", gain(.98)},
          {"gain -5 %", gain(.95)},
          {"bias .05", bias(.05)},
          {"bias .1", bias(.1)},
          {"bias .2", bias(.2)},
          {"noise x 1.5", same, 1.5},
          {"noise x 2", same, 2},
          {"ramp .01 /s", [](double y, double t) { return y + .01 * t; }},
          {"saturation 7.5", [](double y, double) { return std::clamp(y, -7.5, 7.5); }},
          {"dead", gain(0)}};
}

/// s: a bank of its own in NumPy, sensors known, at one false alarm in 1e5 s (h = 23.6); sensors 1, 3, 6.
constexpr double kLimits[][3] = {{.49, .76, 2.0}, {.083, .16, .34}, {.013, .034, .080}, {.43, .78, 2.2},
                                 {.11, .23, .50}, {.03, .06, .11},  {1.4, .73, .65},    {.37, .21, .18},
                                 {3.2, 4.3, 5.5}, {.067, .17, .47}, {.005, .005, .005}};

Array gyroscopes(std::int64_t fault_free) {
  Array array;
  array.channels = Gyroscopes::kSensors;
  array.rate_hz = kRate;
  array.fault_free_samples = fault_free;
  return array;
}

constexpr std::int64_t kFaultFree = 20000;

struct Trial {
  double delay = -1;
  bool right = false;
  std::string kind;
  bool early = false;  ///< an event before the fault
};

Trial one_trial(const Fault& fault, int sensor, std::uint64_t seed, double seconds) {
  Gyroscopes gyros(seed);
  Minque minque(gyroscopes(kFaultFree), Settings(Minque::options));
  double y[Gyroscopes::kSensors];
  // On a full second, as in the scene: the phase of the input decides on the shortest delays.
  const auto onset = kFaultFree;
  const auto end = onset + static_cast<std::int64_t>(seconds * kRate);
  Trial trial;
  for (std::int64_t k = 0; k < end; ++k) {
    if (k == onset) gyros.noise[sensor] = fault.noise;
    gyros.next(y);
    if (k >= onset) y[sensor] = fault.how(y[sensor], static_cast<double>(k - onset + 1) / kRate);
    minque.step(Sample(y, Gyroscopes::kSensors));
    const auto events = minque.faults().events();
    if (events.empty()) continue;
    trial.early = events[0].sample < onset;
    trial.delay = static_cast<double>(events[0].sample - onset + 1) / kRate;
    trial.right = events[0].channel == sensor;
    trial.kind = name(events[0].rule);
    break;
  }
  return trial;
}

void delays(int trials) {
  fmt::print("fault            sensor   mean s   limit  ratio  found  isolated  kinds\n");
  const auto faults = faults_of_interest();
  for (std::size_t f = 0; f < faults.size(); ++f)
    for (int s = 0; s < 3; ++s) {
      const int sensor = s == 0 ? 0 : s == 1 ? 2 : 5;
      double sum = 0;
      int found = 0, right = 0, early = 0;
      std::vector<std::pair<std::string, int>> kinds;
      for (int t = 0; t < trials; ++t) {
        const Trial trial = one_trial(faults[f], sensor, static_cast<std::uint64_t>(1000 * t) + 10 * f + 1, 60);
        if (trial.early) {
          ++early;
          continue;
        }
        if (trial.delay < 0) continue;
        ++found;
        sum += trial.delay;
        right += trial.right ? 1 : 0;
        auto place = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == trial.kind; });
        if (place == kinds.end()) place = kinds.insert(place, {trial.kind, 0});
        ++place->second;
      }
      std::string list;
      for (const auto& [kind, count] : kinds) list += fmt::format(" {} {}", count, kind);
      const double mean = found > 0 ? sum / found : std::nan(""), limit = kLimits[f][s];
      fmt::print("{:<16} {:>6} {:>8.3f} {:>7.3f} {:>6.2f} {:>3}/{} {:>8} {}{}\n", faults[f].name, sensor + 1, mean,
                 limit, mean / limit, found, trials, right, list, early > 0 ? fmt::format("  EARLY {}", early) : "");
    }
}

void clean(std::int64_t samples) {
  struct Case {
    const char* name;
    Wrongs wrongs;
  };
  for (const Case& c : {Case{"white", {0, 0, 0, 0}}, Case{"B 8e-4", {8e-4, 0, 0, 0}},
                        Case{"B 8e-4, gains 1 %, delays 1/2", {8e-4, 0, .01, .5}},
                        Case{"B 8e-4, K 3e-4, gains 1 %, delays 1/2", {8e-4, 3e-4, .01, .5}}}) {
    // Records of 1e6 samples, each with its own start.
    std::int64_t events = 0, doubts = 0, records = samples / 1000000, done = 0;
    std::string first;
    for (std::int64_t r = 0; r < records; ++r) {
      Gyroscopes gyros(static_cast<std::uint64_t>(770001 + r), c.wrongs);
      Minque minque(gyroscopes(kFaultFree), Settings(Minque::options));
      double y[Gyroscopes::kSensors];
      for (int k = 0; k < 1000000; ++k, ++done) {
        gyros.next(y);
        minque.step(Sample(y, Gyroscopes::kSensors));
      }
      for (const FaultEvent& e : minque.faults().events())
        if (e.faulty) {
          ++events;
          if (first.size() < 200) first += fmt::format(" {}@{}:{}", name(e.rule), e.sample, e.channel + 1);
        }
      doubts += static_cast<std::int64_t>(minque.faults().doubts().size());
    }
    const double seconds = static_cast<double>(done) / kRate;
    fmt::print("{:<40} {} samples: {} alarms, {} doubts; {:.2f} in 1e5 s {}\n", c.name, done, events, doubts,
               static_cast<double>(events + doubts) / seconds * 1e5, first);
  }
}

void recovery() {
  const auto all = faults_of_interest();
  fmt::print("fault lasts 150 s: events while it stands; then time until in again\n");
  for (const std::size_t f : {1U, 2U, 4U, 5U, 10U})
    for (const int sensor : {0, 2, 5}) {
      double sum = 0, longest = 0;
      int returned = 0, early = 0, trials = 10;
      for (int t = 0; t < trials; ++t) {
        Gyroscopes gyros(static_cast<std::uint64_t>(5000 + 31 * t) + f);
        Minque minque(gyroscopes(kFaultFree), Settings(Minque::options));
        double y[Gyroscopes::kSensors];
        const std::int64_t onset = kFaultFree + 100, over = onset + 30000, end = over + 4000;
        for (std::int64_t k = 0; k < end; ++k) {
          gyros.next(y);
          if (k >= onset && k < over) y[sensor] = all[f].how(y[sensor], 1);
          minque.step(Sample(y, Gyroscopes::kSensors));
        }
        for (const FaultEvent& e : minque.faults().events()) {
          if (e.faulty || e.channel != sensor) continue;
          if (e.sample < over)
            ++early;
          else {
            ++returned;
            sum += static_cast<double>(e.sample - over) / kRate;
            longest = std::max(longest, static_cast<double>(e.sample - over) / kRate);
            break;
          }
        }
      }
      fmt::print("{:<12} sensor {}: early returns {}, in again {}/{} after {:.2f} s (longest {:.2f})\n", all[f].name,
                 sensor + 1, early, returned, trials, sum / std::max(returned, 1), longest);
    }
}

void sets(int trials) {
  struct Case {
    const char* name;
    std::vector<int> sensors;
    std::vector<double> gains, biases;
  };
  const std::vector<Case> cases{
      {"bias .2 on 1, 2", {0, 1}, {1, 1}, {.2, .2}},
      {"bias .5 on 1, 2", {0, 1}, {1, 1}, {.5, .5}},
      {"gain .9 on 1, 2", {0, 1}, {.9, .9}, {0, 0}},
      {"gain .8 on 3, 4", {2, 3}, {.8, .8}, {0, 0}},
      {"gain .9 and bias .3 on 2, 5", {1, 4}, {.9, 1}, {0, .3}},
      {"bias .3, -.2, .5 on 1, 2, 3", {0, 1, 2}, {1, 1, 1}, {.3, -.2, .5}},
      {"gain .9 .8 .7 on 1, 3, 5", {0, 2, 4}, {.9, .8, .7}, {0, 0, 0}},
      {"gain .9 on 1, 2, 3", {0, 1, 2}, {.9, .9, .9}, {0, 0, 0}},
      {"bias .5 on 1, 2, 3", {0, 1, 2}, {1, 1, 1}, {.5, .5, .5}},
  };
  for (const Case& c : cases) {
    int right = 0, ambiguous = 0, wrong = 0;
    for (int t = 0; t < trials; ++t) {
      Gyroscopes gyros(static_cast<std::uint64_t>(9000 + 17 * t));
      Minque minque(gyroscopes(kFaultFree), Settings(Minque::options));
      double y[Gyroscopes::kSensors];
      const std::int64_t onset = kFaultFree + 40 * t;
      for (std::int64_t k = 0; k < onset + 2000; ++k) {
        gyros.next(y);
        if (k >= onset)
          for (std::size_t j = 0; j < c.sensors.size(); ++j)
            y[c.sensors[j]] = y[c.sensors[j]] * c.gains[j] + c.biases[j];
        minque.step(Sample(y, Gyroscopes::kSensors));
      }
      std::vector<char> out(Gyroscopes::kSensors, 0);
      for (const FaultEvent& e : minque.faults().events()) out[static_cast<std::size_t>(e.channel)] = e.faulty ? 1 : 0;
      bool same = true, none = true;
      for (int i = 0; i < Gyroscopes::kSensors; ++i) {
        const bool hurt = std::find(c.sensors.begin(), c.sensors.end(), i) != c.sensors.end();
        same = same && hurt == (out[static_cast<std::size_t>(i)] != 0);
        none = none && out[static_cast<std::size_t>(i)] == 0;
      }
      bool doubted = false;
      for (const FaultDoubt& d : minque.faults().doubts()) doubted = doubted || d.ambiguous;
      if (same)
        ++right;
      else if (none && doubted)
        ++ambiguous;
      else
        ++wrong;
    }
    fmt::print("{:<32} right {:>3}, ambiguous {:>3}, else {:>3} of {}\n", c.name, right, ambiguous, wrong, trials);
  }
}

void matrix(int trials) {
  constexpr int kN = 8;
  Array array;
  array.channels = kN;
  array.rate_hz = kRate;
  array.fault_free_samples = kFaultFree;
  array.observation_matrix.resize(kN, 2);
  const double arms[kN] = {.02, .06, .11, .17, .24, .3, .37, .45};
  for (int i = 0; i < kN; ++i) array.observation_matrix.row(i) << 1, -arms[i];
  const Fault faults[] = {{"none", [](double y, double) { return y; }},
                          {"gain -.2", [](double y, double) { return .8 * y; }},
                          {"gain -.05", [](double y, double) { return .95 * y; }},
                          {"bias .05", [](double y, double) { return y + .05; }},
                          {"noise x 3", [](double y, double) { return y; }, 3},
                          {"dead", [](double, double) { return 0.0; }}};
  // h over the information of one sample in the residual of sensor 3, h = 23.6.
  Eigen::VectorXd deviations(kN);
  for (int i = 0; i < kN; ++i) deviations[i] = .0523 * (1 + .25 * i);
  const Eigen::MatrixXd& h = array.observation_matrix;
  const Eigen::MatrixXd weighted = deviations.cwiseAbs2().cwiseInverse().asDiagonal() * h;
  const double leverage = (h.row(2) * test::inverse(h.transpose() * weighted) * weighted.row(2).transpose()).value();
  const double v = deviations[2] * deviations[2] / (1 - leverage);
  const double input = 7.854 * 7.854 / 2 + arms[2] * arms[2] * 25 / 2;
  const double ratio = 9 * (1 - leverage) + leverage;
  const double information[] = {
      1e-9, .04 * input / (2 * v), .0025 * input / (2 * v), .0025 / (2 * v), (ratio - 1 - std::log(ratio)) / 2, 1e9};
  for (std::size_t f = 0; f < std::size(faults); ++f) {
    double sum = 0;
    int found = 0, right = 0, early = 0;
    for (int t = 0; t < trials; ++t) {
      test::Gaussian gauss(static_cast<std::uint64_t>(3100 + 13 * t) + f);
      Minque minque(array, Settings(Minque::options));
      double y[kN];
      const std::int64_t onset = kFaultFree + 37 * t % 400;
      for (std::int64_t k = 0; k < onset + 12000; ++k) {
        const double time = static_cast<double>(k) / kRate;
        const double x0 = 7.854 * std::sin(31.4 * time), x1 = 5 * std::sin(17.3 * time + 1);
        for (int i = 0; i < kN; ++i) {
          const double s = deviations[i];
          y[i] = x0 - arms[i] * x1 + s * (i == 2 && k >= onset ? faults[f].noise : 1) * gauss();
        }
        if (k >= onset) y[2] = faults[f].how(y[2], 1);
        minque.step(Sample(y, kN));
        const auto events = minque.faults().events();
        if (events.empty()) continue;
        if (events[0].sample < onset) {
          ++early;
        } else {
          ++found;
          sum += static_cast<double>(events[0].sample - onset + 1) / kRate;
          right += events[0].channel == 2 ? 1 : 0;
        }
        break;
      }
    }
    fmt::print("r = 2, n = 8: {:<10} {:.3f} s (limit {:.3f}) found {}/{} isolated {} early {}\n", faults[f].name,
               sum / std::max(found, 1), std::max(23.6 / information[f], 1.0) / kRate, found, trials, right, early);
  }
}

void speed() {
  for (const double detection : {0.0, 2.0, 1.0}) {
    Gyroscopes gyros(1);
    Settings settings(Minque::options);
    settings.set("fault_detection", detection);
    constexpr int kInstants = 40000, kRound = 1000;  // short rounds: the machine is shared
    std::vector<double> y(static_cast<std::size_t>(kInstants) * Gyroscopes::kSensors);
    for (int k = 0; k < kInstants; ++k) gyros.next(&y[static_cast<std::size_t>(k) * 6]);
    double best = 1e300;
    Minque minque(gyroscopes(2000), settings);
    for (int round = 0; round < 800; ++round) {
      const auto from = std::chrono::steady_clock::now();
      const int first = round % 40 * kRound;
      for (int k = first; k < first + kRound; ++k) minque.step(Sample(&y[static_cast<std::size_t>(k) * 6], 6));
      const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - from;
      best = std::min(best, took.count() / kRound);
    }
    fmt::print("n = 6, fault_detection {}: {:.1f} ns a step\n", detection, best);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "delays";
  const double number = argc > 2 ? std::atof(argv[2]) : 0;
  const int trials = number > 0 ? static_cast<int>(number) : 30;
  if (what == "delays") delays(trials);
  if (what == "clean") clean(number > 0 ? static_cast<std::int64_t>(number) : 20000000);
  if (what == "recovery") recovery();
  if (what == "sets") sets(trials);
  if (what == "matrix") matrix(trials);
  if (what == "speed") speed();
}
