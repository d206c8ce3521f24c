// A log fused with what a replay learnt: the estimates of the replay itself, and what does not fit.
#include "libchar/replay/fuse.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "libchar/core/error.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/replay/detail/learnt_fusion.hpp"
#include "libchar/replay/detail/plan/step_noise.hpp"
#include "libchar/replay/replay.hpp"
#include "tests/replay/kept_columns.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

// Four sensors of a swinging input: the second late and with too much gain, the third with an offset, the
// fourth noisy and with gaps; `fault`: from half of the log on the first is off by 3.
struct LogOptions {
  int rows = 4000;
  double rate_hz = 100, fault = 0, noise = 0.02;
  double noisy = 1;  // the first has so many times the noise
  std::uint64_t seed = 7;
  double late = 0.4;  // of b, in samples at 100 Hz
  std::string head = "t[s],a[deg/s],b[deg/s],c[deg/s],d[deg/s],x[deg/s]";
};

std::string four_sensors(const LogOptions& o = {}) {
  std::string text = o.head + "\n";
  test::Gaussian gauss(o.seed);
  const auto motion = [&](double k) {
    const double t = k * 100 / o.rate_hz;
    return 3 * std::sin(0.031 * t) + 2 * std::sin(0.0123 * t + 1) + std::sin(0.0471 * t);
  };
  for (int k = 0; k < o.rows; ++k) {
    const double t = k, late = o.late * o.rate_hz / 100;
    const double a = motion(t) + o.noise * o.noisy * gauss() + (2 * k >= o.rows ? o.fault : 0);
    const double b = 1.03 * motion(t - late) + o.noise * gauss();
    const double c = motion(t) + 0.5 + o.noise * gauss(), d = motion(t) + 3 * o.noise * gauss();
    text += fmt::format("{},{},{},{},{},{}\n", shortest(k / o.rate_hz), shortest(a), shortest(b), shortest(c),
                        k % 53 == 20 ? "" : shortest(d), shortest(motion(t)));
  }
  return text;
}

const std::string kScene =
    "format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, {name: b, noise: 0.02}, c, d]\n";

const std::string kNoisyScene =
    "format: scene\nversion: 1\nrecording: log.csv\nsensors:\n  - {name: a, noise: 0.02}\n"
    "  - {name: b, noise: 0.02}\n  - {name: c, noise: 0.02}\n  - {name: d, noise: 0.06}\n";

struct FuseBench {
  explicit FuseBench(const std::string& scene, const std::string& log = four_sensors()) {
    bench.put("log.csv", log);
    const Scene read = bench.read(scene);
    ReplayWorkspace workspace;
    workspace.estimates = &replayed;
    ReplayOptions options;
    options.published = true;
    result = replay(read, options, no_progress(), workspace);
    learnt = parse_fusion_file(fusion_yaml(result.learnt), "fusion.yaml");
  }
  FuseResult fuse_log(KeptColumns& kept, const FuseOptions& options, const std::string& log = "log.csv") const {
    return fuse(bench.path(log), learnt, kept, options);
  }
  std::string refusal(const FuseOptions& options, const std::string& log = "log.csv") const {
    KeptColumns kept;
    try {
      fuse_log(kept, options, log);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  test::SceneBench bench;
  KeptColumns replayed;
  ReplayResult result;
  LearntFusion learnt;
};

std::size_t differences(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k] != b[k] && !(std::isnan(a[k]) && std::isnan(b[k]))) ++count;
  return count;
}

FuseOptions by(const std::string& label) {
  FuseOptions options;
  options.algorithm = label;
  return options;
}

}  // namespace

TEST_CASE("what an algorithm remarks while it fuses has the names of the sensors") {
  CHECK(array_of(FuseBench(kNoisyScene).learnt).names == std::vector<std::string>{"a", "b", "c", "d"});
}

TEST_CASE("fuse: the log that it was learnt from gives the replay's estimates, bit for bit") {
  const std::string all =
      "sensors:\n"
      "  - {name: a, noise: 0.02}\n  - {name: b, noise: 0.02, scale: 0.5, unit: deg/s}\n"
      "  - {name: c, noise: 0.02}\n  - {name: d, noise: 0.06}\n";
  const std::string head = "format: scene\nversion: 1\nrecording: log.csv\n";
  const std::string aligned = GENERATE(std::string(), std::string("align: {learn: [0, 15]}\n"),
                                       std::string("align: {learn: run, interpolation: cubic}\n"));
  const FuseBench bench(
      head + all + "reference: x\nlearning: [0, 15]\nevaluation: [0, end]\n" + "fault_free_s: 10\n" + aligned,
      four_sensors({.fault = 3}));
  int applied = 0;
  for (const LearntAlgorithm& algorithm : bench.learnt.algorithms) {
    INFO(algorithm.label);
    if (!algorithm.refused.empty()) {
      CHECK_THAT(bench.refusal(by(algorithm.label)), Contains("bound"));
      continue;
    }
    ++applied;
    KeptColumns kept;
    const FuseResult fused = bench.fuse_log(kept, by(algorithm.label));
    CHECK(fused.instants == 4000);
    // The simplex learns again from the reference when a sensor fails: in a replay, not here.
    const auto differ = differences(kept.columns[0], bench.replayed.of(algorithm.label));
    CHECK(differ <= (algorithm.label == "neural-simplex" ? 400 : 0));
    // Blocks of any size.
    FuseOptions small = by(algorithm.label);
    small.block = 7;
    KeptColumns pieces;
    bench.fuse_log(pieces, small);
    for (std::size_t c = 0; c < kept.columns.size(); ++c) CHECK(differences(kept.columns[c], pieces.columns[c]) == 0);
  }
  CHECK(applied >= 15);
}

TEST_CASE("fuse: rest, several inputs and a tilt as the replay has them") {
  SECTION("offsets at rest are subtracted") {
    const FuseBench bench(kScene + "rest: [0, 5]\n");
    KeptColumns kept;
    bench.fuse_log(kept, by("median"));
    CHECK(differences(kept.columns[0], bench.replayed.of("median")) == 0);
  }
  SECTION("units that the scene says in place of the log") {
    const FuseBench bench(
        "format: scene\nversion: 1\nrecording: {file: log.csv, units: [rad/s]}\n"
        "sensors: [{name: a, scale: 2, unit: rad/s}, b, c]\n");
    KeptColumns kept;
    const FuseResult fused = bench.fuse_log(kept, by("mean"));
    CHECK(differences(kept.columns[0], bench.replayed.of("mean")) == 0);
    CHECK(fused.sensors[0].unit == "rad/s");
    CHECK(fused.sensors[1].unit == "rad/s");
  }
  SECTION("trends and filters run over the new log") {
    const std::string prepared =
        GENERATE(std::string("high_pass_hz: 0.05\n"), std::string("band_hz: [0.05, 20]\n"),
                 std::string("detrend: line\n"), std::string("align: {learn: [0, 35]}\nhigh_pass_hz: 0.1\n"));
    const FuseBench bench(kScene + prepared);
    KeptColumns kept;
    bench.fuse_log(kept, by("mean"));
    CHECK(differences(kept.columns[0], bench.replayed.of("mean")) == 0);
  }
  SECTION("three sensors of two inputs") {
    const FuseBench bench(
        "format: scene\nversion: 1\nrecording: log.csv\nsensors:\n  - {name: a, h: [1, 0]}\n"
        "  - {name: b, h: [1, 1]}\n  - {name: c, h: [0, 1]}\n  - {name: d, h: [0.5, 2]}\n"
        "  - {name: x, h: [2, -1]}\n");
    KeptColumns kept;
    const FuseResult fused = bench.fuse_log(kept, by("minque"));
    REQUIRE(fused.inputs.size() == 2);
    const std::size_t first = bench.result.learnt.inputs.size();
    CHECK(first == 2);
    CHECK(differences(kept.columns[0], bench.replayed.of("mean input1")) > 0);
    CHECK(kept.head.channels[2].name == "input1 sd");
  }
  SECTION("a tilt in the reference's unit") {
    const FuseBench bench(
        "format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b, c]\n"
        "tilt: {gyroscope: a, accelerometer_x: b, accelerometer_z: c}\n"
        "reference: {channels: [x]}\nlearning: [0, 15]\nevaluation: [0, end]\n",
        four_sensors({.head = "t[s],a[deg/s],b[m/s^2],c[m/s^2],d[1],x[deg]"}));
    for (const char* label : {"tilt-kalman", "tilt-complementary-tuned", "tilt-kalman-tuned"}) {
      KeptColumns kept;
      const FuseResult fused = bench.fuse_log(kept, by(label));
      CHECK(fused.inputs[0].unit == "deg");
      CHECK(differences(kept.columns[0], bench.replayed.of(label)) == 0);
    }
  }
}

TEST_CASE("fuse: a new log, its deviations and flags") {
  // Aligned: a gain of 3 % is a fault too.
  const FuseBench bench(kScene + "reference: x\nlearning: [0, 15]\nalign: {learn: [0, 15]}\n");
  bench.bench.put("new.csv", four_sensors({.rows = 6000, .fault = 3, .seed = 11}));
  KeptColumns kept;
  FuseOptions options = by("minque");
  options.fault_free_s = 20;
  const FuseResult fused = bench.fuse_log(kept, options, "new.csv");
  REQUIRE(kept.columns.size() == 6);
  CHECK(kept.head.channels[0].name == "x");
  CHECK(kept.head.channels[1].name == "x sd");
  CHECK(kept.head.channels[2].name == "a used");
  CHECK(fused.watches_faults);
  REQUIRE_FALSE(fused.faults.empty());
  CHECK(fused.faults[0].sensor == 0);
  CHECK(fused.faults[0].from_s == Approx(30).margin(0.5));
  CHECK(fused.sensors[0].out > 2900);
  CHECK(fused.sensors[0].out < 3001);
  CHECK(kept.columns[2][100] == 1);
  CHECK(kept.columns[2][5000] == 0);
  CHECK(std::isnan(kept.columns[5][20]));
  // It is not late and read at its own samples; at the end of the log another sensor is late.
  CHECK(fused.sensors[3].missing == 113 + 1);
  CHECK(fused.deviations > 5900);
}

TEST_CASE("fuse: where another log is healthy nobody knows unless it is said") {
  const FuseBench bench(kScene + "reference: x\nlearning: [0, 15]\nfault_free_s: 10\n");
  bench.bench.put("new.csv", four_sensors({.seed = 12}));
  const auto watched = [&](const FuseOptions& options, const std::string& log) {
    KeptColumns kept;
    return bench.fuse_log(kept, options, log).warnings.find("faults_not_watched") == nullptr;
  };
  CHECK(watched(by("minque-published"), "log.csv"));
  CHECK_FALSE(watched(by("minque-published"), "new.csv"));
  FuseOptions known = by("minque-published");
  known.fault_free_s = 10;
  CHECK(watched(known, "new.csv"));
}

TEST_CASE("fuse: a sensor that the log does not have") {
  const FuseBench bench(kScene + "reference: x\nlearning: [0, 15]\n");
  bench.bench.put("less.csv", four_sensors({.head = "t[s],a[deg/s],b[deg/s],e[deg/s],d[deg/s],y[deg/s]"}));
  KeptColumns kept;
  const FuseResult fused = bench.fuse_log(kept, by("least-squares"), "less.csv");
  REQUIRE(fused.warnings.find("sensor_not_in_log") != nullptr);
  CHECK(fused.warnings.find("sensor_not_in_log")->where.rows == std::vector<std::string>{"c"});
  CHECK(fused.sensors[2].missing == 4000);
  CHECK(fused.estimates == 4000);
  CHECK_THAT(bench.refusal(by("perceptron"), "less.csv"),
             Contains("perceptron cannot run without it") && Contains("`map`"));
  // Under another name.
  FuseOptions mapped = by("least-squares");
  mapped.map = {{"c", "e"}};
  KeptColumns whole, same;
  CHECK(bench.fuse_log(whole, mapped, "less.csv").warnings.find("sensor_not_in_log") == nullptr);
  bench.fuse_log(same, by("least-squares"));
  CHECK(differences(whole.columns[0], same.columns[0]) == 0);
  mapped.map = {{"c", "f"}};
  CHECK_THAT(bench.refusal(mapped, "less.csv"), Contains("no channel of this name"));
  mapped.map = {{"q", "e"}};
  CHECK_THAT(bench.refusal(mapped, "less.csv"), Contains("no sensor of this name"));
  bench.bench.put("other.csv", "t[s],p,q\n0,1,2\n1,2,3\n2,3,4\n");
  CHECK_THAT(bench.refusal(by("mean"), "other.csv"), Contains("p, q") && Contains("a, b, c, d"));
}

TEST_CASE("fuse: what does not fit is refused in a sentence") {
  const FuseBench bench(kNoisyScene + "reference: x\nlearning: [0, 15]\n");
  bench.bench.put("rad.csv", four_sensors({.head = "t[s],a[rad/s],b[deg/s],c[deg/s],d[deg/s],x[deg/s]"}));
  CHECK(bench.refusal(by("mean"), "rad.csv").empty());  // converted: see below
  bench.bench.put("volt.csv", four_sensors({.head = "t[s],a[V],b[deg/s],c[deg/s],d[deg/s],x[deg/s]"}));
  CHECK_THAT(bench.refusal(by("mean"), "volt.csv"), Contains("V") && Contains("another unit"));
  bench.bench.put("dps.csv", four_sensors({.head = "t[s],a[dps],b,c[°/s],d[deg/s],x"}));
  CHECK(bench.refusal(by("mean"), "dps.csv").empty());
  CHECK_THAT(bench.refusal(by("meen")), Contains("did you mean mean?"));
  FuseOptions channels;
  channels.reading.channels = {"a"};
  CHECK_THAT(bench.refusal(channels), Contains("`map`"));
  bench.bench.put("fast.csv", four_sensors({.rate_hz = 200}));
  CHECK_THAT(bench.refusal(by("kalman-takens-taught"), "fast.csv"), Contains("2 times"));
  KeptColumns kept;
  const FuseResult fast = bench.fuse_log(kept, by("mean"), "fast.csv");
  CHECK(fast.warnings.find("another_rate") != nullptr);
}

TEST_CASE("fuse: a channel in another unit of its quantity is converted") {
  const FuseBench bench(kNoisyScene + "reference: x\nlearning: [0, 15]\n");
  const std::string head = "t[s],a[rad/s],b[deg/s],c[deg/s],d[deg/s],x[deg/s]";
  std::string turned = head + "\n";  // the numbers of the first channel in rad/s
  std::istringstream lines(four_sensors());
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const std::size_t from = line.find(',') + 1, to = line.find(',', from);
    const double value = std::stod(line.substr(from, to - from));
    turned += line.substr(0, from) + shortest(value / 57.29577951308232) + line.substr(to) + "\n";
  }
  bench.bench.put("turned.csv", turned);
  KeptColumns as_it_was, converted;
  bench.fuse_log(as_it_was, by("mean"));
  bench.fuse_log(converted, by("mean"), "turned.csv");
  double most = 0;
  for (std::size_t k = 0; k < converted.columns[0].size(); ++k)
    most = std::max(most, std::abs(converted.columns[0][k] - as_it_was.columns[0][k]));
  CHECK(converted.columns[0].size() == as_it_was.columns[0].size());
  CHECK(most < 1e-12);
}

TEST_CASE("fuse: at another rate delays keep their seconds") {
  const FuseBench bench(kScene + "reference: x\nalign: {learn: [0, 35]}\nevaluation: [36, end]\n");
  REQUIRE(bench.learnt.sensors[1].alignment.delay_samples == Approx(0.4).margin(0.02));
  bench.bench.put("fast.csv", four_sensors({.rows = 8000, .rate_hz = 200, .noise = 1e-4}));
  KeptColumns kept;
  bench.fuse_log(kept, by("mean"), "fast.csv");
  const Recording fast = read_recording(bench.bench.path("fast.csv"));
  double largest = 0;
  for (std::size_t k = 100; k < 7900; ++k)
    largest = std::max(largest, std::abs(kept.columns[0][k] - fast.samples[4][k]));
  CHECK(largest < 0.01);
}

TEST_CASE("fuse: a sensor that is many samples late is waited for, and at the ends there is no array") {
  const FuseBench bench(kScene + "reference: x\nalign: {learn: [0, 35]}\nevaluation: [36, end]\n",
                        four_sensors({.late = 30}));
  REQUIRE(bench.learnt.sensors[1].alignment.delay_samples == Approx(30).margin(0.02));
  KeptColumns kept;
  bench.fuse_log(kept, by("mean"));
  const Recording log = read_recording(bench.bench.path("log.csv"));
  double largest = 0;
  for (std::size_t k = 100; k < 3900; ++k)
    largest = std::max(largest, std::abs(kept.columns[0][k] - log.samples[4][k]));
  CHECK(largest < 0.2);
  CHECK(std::isnan(kept.columns[0][log.samples[0].size() - 10]));
}

TEST_CASE("fuse: the file names what is wrong with it, and where") {
  const FuseBench bench(kScene + "reference: x\nlearning: [0, 15]\n");
  const std::string text = fusion_yaml(bench.result.learnt);
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    REQUIRE(at != std::string::npos);
    changed.replace(at, from.size(), to);
    try {
      const LearntFusion learnt = parse_fusion_file(changed, "f.yaml");
      KeptColumns kept;
      fuse(bench.bench.path("log.csv"), learnt, kept, by("least-squares"));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(refused("name: \"a\"", "name: \"a\"").empty());
  CHECK_THAT(refused("version: 1", "version: 2"), Contains("f.yaml:3:10") && Contains("newer"));
  CHECK_THAT(refused("recommended:", "recomended:"), Contains("did you mean recommended"));
  CHECK_THAT(refused("weights: [", "weights: [.nan, "), Contains("weights") && Contains("f.yaml:"));
  CHECK_THAT(refused("weights: [", "weights: [0.5, "), Contains("expected 4 numbers, found 5") && Contains("f.yaml:"));
  CHECK_THAT(refused("gains:", "gain:"), Contains("learnt."));
  CHECK_THAT(refused("name: \"b\"", "name: \"a\""), Contains("two sensors have the name a"));
  CHECK_THAT(refused("complete: true", ""), Contains("cut off"));
  CHECK_THAT(refused("rate_hz: ", "rate_hz: -"), Contains("rate_hz"));
  // Cut off anywhere it is never taken for whole.
  for (std::size_t size = 0; size + 2 < text.size(); size += 1 + text.size() / 200)
    CHECK_THROWS_AS(parse_fusion_file(text.substr(0, size), "f.yaml"), Error);
}

TEST_CASE("fuse: numbers of the file read back to the same bits") {
  const FuseBench bench(kScene + "reference: x\nlearning: [0, 15]\nalign: {learn: [0, 15]}\nrest: [0, 2]\n");
  CHECK(fusion_yaml(bench.learnt) == fusion_yaml(bench.result.learnt));
  const LearntFusion& written = bench.result.learnt;
  for (std::size_t i = 0; i < written.sensors.size(); ++i) {
    CHECK(written.sensors[i].offset == bench.learnt.sensors[i].offset);
    CHECK(written.sensors[i].alignment.delay_samples == bench.learnt.sensors[i].alignment.delay_samples);
    CHECK(written.sensors[i].noise_variance == bench.learnt.sensors[i].noise_variance);
  }
  for (std::size_t k = 0; k < written.algorithms.size(); ++k)
    for (std::size_t j = 0; j < written.algorithms[k].learnt.size(); ++j)
      CHECK(written.algorithms[k].learnt[j].values == bench.learnt.algorithms[k].learnt[j].values);
}

TEST_CASE("fuse: a sensor that is noisier than where it was learnt is named") {
  const FuseBench bench(kScene + "reference: x\nlearning: [0, 15]\n");
  const auto warned = [&](const LogOptions& o, const char* code) {
    bench.bench.put("new.csv", four_sensors(o));
    KeptColumns kept;
    const FuseResult fused = bench.fuse_log(kept, by("least-squares"), "new.csv");
    const Finding* warning = fused.warnings.find(code);
    return warning == nullptr ? "" : warning->where.rows[0];
  };
  CHECK(warned({.rows = 8000, .seed = 21}, "noise_changed").empty());
  CHECK_THAT(warned({.rows = 8000, .noisy = 4, .seed = 22}, "noise_changed"),
             Contains("a is 4") || Contains("a is 3.9") || Contains("a is 4.1"));
  CHECK_THAT(warned({.rows = 8000, .noise = 0.06, .seed = 23}, "noise_changed_of_all"),
             Contains("3 times") || Contains("2.9 times") || Contains("3.1 times"));
  // A fault is no noise.
  CHECK(warned({.rows = 8000, .fault = 3, .seed = 24}, "noise_changed").empty());
}

TEST_CASE("fuse: no sensor of the same noise is called noisier in 200 logs") {
  test::Gaussian gauss(99);
  const Eigen::MatrixXd h = Eigen::MatrixXd::Ones(4, 1);
  const Eigen::Vector4d deviation(1, 0.3, 2, 1);
  const auto noise = [&](Eigen::Index instants, double first) {
    StepNoiseMeter meter(h, instants);
    Eigen::MatrixXd y(4, instants);
    for (Eigen::Index k = 0; k < instants; ++k)
      for (Eigen::Index i = 0; i < 4; ++i) y(i, k) = deviation[i] * (i == 0 ? first : 1) * gauss() + 100;
    meter.push(y);
    return meter.result();
  };
  const std::vector<std::string> names = {"a", "b", "c", "d"};
  const auto learnt = noise(20000, 1);
  int alarms = 0, found = 0;
  for (int k = 0; k < 200; ++k) {
    Findings same, other;
    warn_of_noise(names, learnt, noise(4000, 1), same);
    warn_of_noise(names, learnt, noise(4000, 2), other);
    alarms += same.empty() ? 0 : 1;
    const Finding* warning = other.find("noise_changed");
    found +=
        warning != nullptr && warning->where.rows.size() == 1 && warning->where.rows[0].starts_with("a is") ? 1 : 0;
  }
  CHECK(alarms == 0);
  CHECK(found >= 195);
}

TEST_CASE("fuse: deviations of simulated sensors hold their errors") {
  const FuseBench bench(
      "format: scene\nversion: 1\nrecording: log.csv\nsensors:\n"
      "  - {name: a, noise: 0.02}\n  - {name: c, noise: 0.02}\n"
      "  - {name: d, noise: 0.06}\n"
      "reference: x\nlearning: [0, 15]\nevaluation: [0, end]\n"
      "align: {learn: run, terms: [bias]}\n");
  bench.bench.put("new.csv", four_sensors({.rows = 20000, .seed = 31}));
  const Recording log = read_recording(bench.bench.path("new.csv"));
  for (const char* label : {"mean", "inverse-variance", "minque", "random-weighting", "least-squares",
                            "shrunk-least-squares", "non-negative-least-squares"}) {
    INFO(label);
    KeptColumns kept;
    bench.fuse_log(kept, by(label), "new.csv");
    double sum = 0, count = 0;
    for (std::size_t k = 4000; k < 20000; ++k) {
      const double ratio = (kept.columns[0][k] - log.samples[4][k]) / kept.columns[1][k];
      if (std::isnan(ratio)) continue;
      sum += ratio * ratio;
      count += 1;
    }
    CHECK(count > 15000);
    CHECK(std::sqrt(sum / count) == Approx(1).margin(0.06));
  }
}

TEST_CASE("fuse: the noise of hundreds of sensors is told in closed form, sensor by sensor") {
  test::Gaussian gauss(7);
  const Eigen::Index n = 100, instants = 3000;
  StepNoiseMeter meter(Eigen::MatrixXd::Ones(n, 1), instants);
  Eigen::MatrixXd y(n, instants);
  for (Eigen::Index k = 0; k < instants; ++k) {
    const double common = 10 * gauss();
    for (Eigen::Index i = 0; i < n; ++i) y(i, k) = common + (i % 2 == 0 ? 1 : 3) * gauss();
  }
  meter.push(y);
  REQUIRE(meter.identifiable());
  const auto found = meter.result();
  REQUIRE(found.size() == static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    REQUIRE(found[static_cast<std::size_t>(i)]);
    CHECK(found[static_cast<std::size_t>(i)]->log_variance == Approx(std::log(i % 2 == 0 ? 1.0 : 9.0)).margin(0.35));
  }
}

TEST_CASE("step noise: a sensor that becomes noisier is told beside others that are noisier still") {
  const Eigen::Index n = 4, instants = 20000;
  const double noise[] = {0.05, 0.4, 0.3, 0.5};
  const auto changes = [&](double times, double motion, std::uint64_t seed) {
    test::Gaussian gauss(seed);
    StepNoiseMeter meter(Eigen::MatrixXd::Ones(n, 1), instants);
    Eigen::MatrixXd y(n, instants);
    for (Eigen::Index k = 0; k < instants; ++k) {
      const bool late = 2 * k >= instants;
      const double step = (late ? motion : 1) * gauss();
      for (Eigen::Index i = 0; i < n; ++i)
        y(i, k) = (1 + 0.02 * static_cast<double>(i)) * step + (i == 0 && late ? times : 1) * noise[i] * gauss();
    }
    meter.push(y);
    return meter.changes();
  };
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const auto found = changes(5, 1, seed);
    REQUIRE(found.size() == 1);
    CHECK(found[0].sensor == 0);
    CHECK(found[0].times < 7);
    CHECK(found[0].times > (found[0].least ? 2 : 4));
    CHECK(static_cast<double>(found[0].at) == Approx(0.5 * instants).epsilon(0.15));
    CHECK(changes(1, 1, seed).empty());
    CHECK(changes(1, 10, seed).empty());  // gains make noise of the motion
  }
}
