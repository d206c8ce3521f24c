// What fuse states is honest: standard deviations cover what they say, sensors that read otherwise are told.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/text/decimal.hpp"
#include "libchar/replay/detail/coverage_meter.hpp"
#include "libchar/replay/detail/plan/reading_meter.hpp"
#include "libchar/replay/detail/sensor_doubt.hpp"
#include "libchar/replay/fuse.hpp"
#include "libchar/replay/replay.hpp"
#include "tests/replay/kept_columns.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;
using Catch::StartsWith;

namespace {

constexpr int kHonestRows = 12000;
constexpr double kHonestHz = 100;

double honest_truth(int k) { return 2 * std::sin(0.0071 * k) + std::sin(0.0213 * k + 1); }

/// Four sensors, each off by a gain, an offset and its noise; part of the noise common to all.
/// `spoil`: what one sensor reads instead.
std::string honest_log(std::uint64_t seed, double (*spoil)(double y, int k) = nullptr) {
  test::Gaussian gauss(seed);
  const double gain[] = {1.01, 0.99, 1.02, 1}, offset[] = {0.02, -0.03, 0, 0.04};
  const double noise[] = {0.05, 0.1, 0.08, 0.2};
  std::string text = "t[s],a[deg/s],b[deg/s],c[deg/s],d[deg/s],x[deg/s]\n";
  for (int k = 0; k < kHonestRows; ++k) {
    const double x = honest_truth(k), common = 0.03 * gauss();
    text += shortest(k / kHonestHz);
    for (int i = 0; i < 4; ++i) {
      double y = gain[i] * x + offset[i] + common + noise[i] * gauss();
      if (i == 1 && spoil != nullptr) y = spoil(y, k);
      text += "," + shortest(y);
    }
    text += "," + shortest(x) + "\n";
  }
  return text;
}

struct HonestBench {
  explicit HonestBench(const std::string& more = "", int sensors = 4, double (*spoil)(double y, int k) = nullptr) {
    bench.put("log.csv", honest_log(1, spoil));
    std::string text = "format: scene\nversion: 1\nrecording: log.csv\nsensors:\n";
    const char* const each[] = {"a, noise: 0.05", "b, noise: 0.1", "c, noise: 0.08", "d, noise: 0.2"};
    for (int i = 0; i < sensors; ++i) text += fmt::format("  - {{name: {}}}\n", each[i]);
    const Scene scene = bench.read(text + "reference: x\nlearning: [0, 50]\n" + more);
    learnt = parse_fusion_file(fusion_yaml(replay(scene, {}).learnt), "fusion.yaml");
  }
  FuseResult fuse_log(const std::string& log, const std::string& algorithm, KeptColumns& kept) {
    bench.put("new.csv", log);
    FuseOptions options;
    options.algorithm = algorithm;
    return fuse(bench.path("new.csv"), learnt, kept, options);
  }
  test::SceneBench bench;
  LearntFusion learnt;
};

/// Share of the errors within 1.96 of the stated deviation; NaN: none is stated.
double coverage(const KeptColumns& kept) {
  double within = 0, all = 0;
  for (int k = 0; k < kHonestRows; ++k) {
    const double x = kept.columns[0][static_cast<std::size_t>(k)];
    const double sd = kept.columns[1][static_cast<std::size_t>(k)];
    if (std::isnan(x) || std::isnan(sd)) continue;
    within += std::abs(x - honest_truth(k)) <= 1.96 * sd ? 1 : 0;
    ++all;
  }
  return within / all;
}

}  // namespace

TEST_CASE("coverage meter: the factor that makes 95 % of normal errors covered") {
  test::Gaussian gauss(4);
  detail::CoverageMeter right, small, none;
  for (int k = 0; k < 100000; ++k) {
    const double e = gauss();
    right.add(e, 1);
    small.add(e, 0.2);  // a deviation stated a fifth of what it is
    none.add(e, std::nan(""));
  }
  CHECK(*right.factor() == Approx(1).epsilon(0.015));
  CHECK(*small.factor() == Approx(5).epsilon(0.015));
  CHECK_FALSE(none.factor());
  detail::CoverageMeter few;
  for (int k = 0; k < 199; ++k) few.add(1, 1);
  CHECK_FALSE(few.factor());
}

TEST_CASE("fuse: standard deviations cover 92 to 97 % on another log, whatever the method states") {
  for (const char* align : {"", "align: {learn: learning}\n"}) {
    HonestBench bench(align);
    int stated = 0;
    for (const LearntAlgorithm& algorithm : bench.learnt.algorithms) {
      if (!algorithm.refused.empty()) continue;
      INFO(algorithm.label << (*align == 0 ? "" : ", aligned"));
      CHECK(algorithm.sd_factor.empty() != algorithm.sd.empty());
      KeptColumns kept;
      bench.fuse_log(honest_log(2), algorithm.label, kept);
      const double share = coverage(kept);
      CHECK(share >= 0.92);
      CHECK(share <= 0.97);
      ++stated;
    }
    CHECK(stated >= 10);
  }
}

TEST_CASE("fuse: without a reference the deviation holds the gain that all sensors share, which nothing tells") {
  // Gains that scatter by 5 %, of an input that moves by ten times the noise: one draw an array, so of many arrays.
  const auto log = [](std::uint64_t array, std::uint64_t seed) {
    test::Gaussian gains(array), gauss(seed);
    double gain[4];
    for (double& one : gain) one = 1 + 0.05 * gains();
    std::string text = "t[s],a[deg/s],b[deg/s],c[deg/s],d[deg/s]\n";
    for (int k = 0; k < kHonestRows; ++k) {
      text += shortest(k / kHonestHz);
      for (const double one : gain) text += "," + shortest(one * honest_truth(k) + 0.15 * gauss());
      text += "\n";
    }
    return text;
  };
  double sum[2] = {};
  constexpr int kArrays = 16;
  for (std::uint64_t array = 1; array <= kArrays; ++array) {
    const test::SceneBench bench;
    bench.put("log.csv", log(array, 100 + array));
    bench.put("new.csv", log(array, 200 + array));
    const Scene scene = bench.read(
        "format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b, c, d]\nalgorithms: [minque, blind-gls]\n");
    const LearntFusion learnt = parse_fusion_file(fusion_yaml(replay(scene, {}).learnt), "fusion.yaml");
    CHECK(learnt.inputs.at(0).gain_sd > 0.003);
    for (const bool gls : {false, true}) {
      KeptColumns kept;
      FuseOptions options;
      options.algorithm = gls ? "blind-gls" : "minque";
      fuse(bench.path("new.csv"), learnt, kept, options);
      sum[gls ? 1 : 0] += coverage(kept) / kArrays;
    }
  }
  for (const double share : sum) CHECK(share >= 0.92);
}

TEST_CASE("replay: beside a reference noise and gains are seen that are lost in the noise of the other sensors") {
  // Of three sensors one is three times as noisy, or has a tenth less gain, in the last third.
  for (const bool gain : {false, true}) {
    const test::SceneBench bench;
    test::Gaussian gauss(gain ? 7 : 8);
    std::string text = "t[s],a[deg/s],b[deg/s],c[deg/s],x[deg/s]\n";
    for (int k = 0; k < kHonestRows; ++k) {
      const double x = honest_truth(k);
      const bool late = 3 * k > 2 * kHonestRows;
      const double a = (late && gain ? 0.9 : 1) * x + (late && !gain ? 3 : 1) * 0.1 * gauss();
      const double b = x + 0.4 * gauss();
      text += shortest(k / kHonestHz) + "," + shortest(a) + "," + shortest(b) + "," + shortest(x + 0.3 * gauss()) +
              "," + shortest(x) + "\n";
    }
    bench.put("log.csv", text);
    const ReplayResult result = replay(bench.read(
        "format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b, c]\nreference: x\nalgorithms: [mean]\n"));
    const Finding* found = result.warnings.find("sensor_failing");
    REQUIRE(found != nullptr);
    CHECK(found->where.rows.size() == 1);
    CHECK_THAT(found->where.rows.at(0), StartsWith("a: "));
    CHECK(result.warnings.find("sensor_unlike") == nullptr);
  }
}

TEST_CASE("reading meter: offset, gain and scatter of a sensor beside the median of all") {
  test::Gaussian gauss(8);
  detail::ReadingMeter meter(5, 20000);
  Eigen::MatrixXd y(5, 20000);
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    const double x = honest_truth(static_cast<int>(k));
    for (Eigen::Index i = 0; i < 5; ++i) y(i, k) = (i == 4 ? 1.1 * x + 0.5 : x) + (i == 4 ? 0.2 : 0.001) * gauss();
  }
  meter.push(y);
  const auto learnt = meter.result();
  REQUIRE(learnt[4]);
  CHECK(learnt[4]->offset == Approx(0.5).margin(0.01));
  CHECK(learnt[4]->gain == Approx(0.1).margin(0.005));
  CHECK(learnt[4]->usual_rms == Approx(0.2).epsilon(0.15));
  CHECK(learnt[4]->usual_mean < 0.06);
  CHECK(meter.changes(learnt).empty());
  // From instant 10240 on the first is off by 0.3; blocks of other lengths tell the same.
  y.row(0).rightCols(20000 - 10240).array() += 0.3;
  detail::ReadingMeter other(5, 20000);
  for (Eigen::Index k = 0; k < y.cols(); k += 1000) other.push(y.middleCols(k, 1000));
  const auto changes = other.changes(learnt);
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].sensor == 0);
  CHECK(changes[0].offset == Approx(0.3).margin(0.01));
  CHECK(changes[0].from == 10240);
  CHECK(changes[0].to_end);
}

TEST_CASE("reading meter: a sensor that is missing moves the median of the others, not the others") {
  for (const Eigen::Index n : {4, 5, 6})
    for (const Eigen::Index gone : {0, 1, 2, 3}) {
      test::Gaussian gauss(9);
      Eigen::MatrixXd y(n, 20000);
      for (Eigen::Index k = 0; k < y.cols(); ++k)
        for (Eigen::Index i = 0; i < n; ++i)
          y(i, k) = honest_truth(static_cast<int>(k)) + 0.2 * static_cast<double>(i * i - 4) + 0.05 * gauss();
      detail::ReadingMeter before(n, 20000), meter(n, 20000), after(n, 20000);
      before.push(y);
      const auto learnt = before.learnt();
      y.row(gone).rightCols(8000).setConstant(std::nan(""));
      meter.push(y);
      CHECK(meter.changes(meter.steady(), true).empty());
      y.row(gone).setConstant(std::nan(""));
      after.expect(learnt);
      after.push(y);
      CHECK(after.changes(learnt).empty());
    }
}

TEST_CASE("reading meter: a gain that is another one from some time on is one that drifts, and sound gains are none") {
  for (const double at : {0.25, 0.65})
    for (const double step : {-0.1, 0.}) {
      test::Gaussian gauss(4);
      Eigen::MatrixXd y(5, 24000);
      for (Eigen::Index k = 0; k < y.cols(); ++k)
        for (Eigen::Index i = 0; i < 5; ++i) {
          const double gain =
              1 + 0.005 * static_cast<double>(i - 2) + (i == 1 && static_cast<double>(k) > at * 24000 ? step : 0);
          y(i, k) = gain * honest_truth(static_cast<int>(k)) + 0.1 * gauss();
        }
      detail::ReadingMeter meter(5, y.cols());
      meter.push(y);
      const auto found = meter.gain_drifts(0.003);
      REQUIRE(found.size() == (step == 0 ? 0 : 1));
      if (step != 0) CHECK(found[0].sensor == 1);
      if (step != 0) CHECK(found[0].to - found[0].from == Approx(step).margin(0.03));
    }
}

TEST_CASE("reading meter: a gain that is another one than where it was learnt") {
  const auto meter_of = [](std::uint64_t seed, double gain) {
    test::Gaussian gauss(seed);
    Eigen::MatrixXd y(5, 24000);
    for (Eigen::Index k = 0; k < y.cols(); ++k)
      for (Eigen::Index i = 0; i < 5; ++i)
        y(i, k) = (i == 1 ? gain : 1) * honest_truth(static_cast<int>(k)) + 0.1 * gauss();
    detail::ReadingMeter meter(5, y.cols());
    meter.push(y);
    return meter;
  };
  const auto learnt = meter_of(4, 1).learnt();
  CHECK(meter_of(5, 1).gain_drifts(0.003, &learnt).empty());
  const detail::ReadingMeter other = meter_of(6, 0.9);
  CHECK(other.gain_drifts(0.003).empty());
  const auto found = other.gain_drifts(0.003, &learnt);
  REQUIRE(found.size() == 1);
  CHECK(found[0].sensor == 1);
  CHECK(found[0].to == Approx(-0.1).margin(0.03));
}

TEST_CASE("reading meter: of a log of more blocks than are kept every second one says the same") {
  constexpr Eigen::Index kInstants = 540000;  // 2109 blocks
  test::Gaussian gauss(3);
  detail::ReadingMeter meter(3, kInstants);
  Eigen::MatrixXd y(3, 1000);
  for (Eigen::Index done = 0; done < kInstants; done += y.cols()) {
    for (double& one : y.reshaped()) one = gauss();
    y.row(2).array() += done < kInstants * 3 / 4 ? 0 : 5;
    meter.push(y);
  }
  const auto changes = meter.changes(meter.steady());
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].sensor == 2);
  CHECK(std::abs(changes[0].from - kInstants * 3 / 4) <= 1024);
  CHECK(changes[0].to_end);
}

TEST_CASE("reading meter: bursts of noise, short pulses and an offset that comes and goes are of the one sensor") {
  constexpr Eigen::Index kInstants = 12000;
  using Fault = double (*)(Eigen::Index k, double noise);
  const std::pair<const char*, Fault> kinds[] = {
      {"none", [](Eigen::Index, double) { return 0.; }},
      {"bursts", [](Eigen::Index k, double noise) { return k / 500 % 4 == 1 ? 8 * noise : 0.; }},
      {"pulses", [](Eigen::Index k, double) { return k > 9000 && k % 1500 < 200 ? 1.5 : 0.; }},
      {"offset", [](Eigen::Index k, double) { return k > 3600 && k / 700 % 3 == 1 ? 1. : 0.; }}};
  for (const auto& [kind, fault] : kinds)
    for (const Eigen::Index n : {3, 4, 6})
      for (std::uint64_t seed = 1; seed < 4; ++seed) {
        INFO(kind << " of " << n << ", " << seed);
        test::Gaussian gauss(10 * seed + static_cast<std::uint64_t>(n));
        Eigen::MatrixXd y(n, kInstants);
        for (Eigen::Index k = 0; k < kInstants; ++k)
          for (Eigen::Index i = 0; i < n; ++i)
            y(i, k) = honest_truth(static_cast<int>(k)) + 0.1 * gauss() + (i == 1 ? fault(k, 0.1 * gauss()) : 0);
        detail::ReadingMeter meter(n, kInstants);
        meter.push(y);
        const auto changes = meter.changes(meter.steady(), true);
        REQUIRE(changes.size() == (fault == kinds[0].second ? 0 : 1));
        if (!changes.empty()) CHECK(changes[0].sensor == 1);
      }
}

TEST_CASE("fuse: a sensor that is broken from the start is told, a healthy log is silent") {
  HonestBench bench;
  const auto told = [&](const std::string& log) -> std::string {
    std::string out;
    for (const char* algorithm : {"least-squares", "minque"}) {
      KeptColumns kept;
      const FuseResult result = bench.fuse_log(log, algorithm, kept);
      const Finding* found = result.warnings.find("sensor_changed");
      out += found == nullptr ? "" : found->where.rows.empty() ? "?" : found->where.rows[0] + "; ";
    }
    return out;
  };
  for (std::uint64_t seed = 2; seed < 6; ++seed) CHECK(told(honest_log(seed)).empty());
  using Spoil = double (*)(double, int);
  const std::pair<const char*, Spoil> kinds[] = {
      {"offset", [](double y, int) { return y + 0.5; }},
      {"sign", [](double y, int) { return -y; }},
      {"gain", [](double y, int) { return 0.8 * y; }},
      {"unit", [](double y, int) { return 57.29578 * y; }},
      {"noise", [](double y, int k) { return y + (k % 2 == 0 ? 0.6 : -0.6); }},
      {"from the middle", [](double y, int k) { return k < 6000 ? y : y + 5; }}};
  for (const auto& [kind, spoil] : kinds) {
    INFO(kind);
    const std::string places = told(honest_log(7, spoil));
    CHECK_THAT(places, Contains("b: up to"));
    CHECK_THAT(places, Contains("to the end"));
    CHECK_THAT(places, Contains(std::string(kind) == "from the middle" ? "from 5" : "from the start"));
    CHECK_THAT(places, !Contains("a: up") && !Contains("c: up") && !Contains("d: up"));
  }
}

TEST_CASE("fuse: single outliers of a sensor are told") {
  HonestBench bench;
  KeptColumns kept;
  const FuseResult spiky =
      bench.fuse_log(honest_log(7, [](double y, int k) { return k % 101 == 50 ? y + 3 : y; }), "minque", kept);
  const Finding* found = spiky.warnings.find("sensor_apart");
  REQUIRE(found != nullptr);
  REQUIRE(found->where.rows.size() == 1);
  CHECK_THAT(found->where.rows[0], StartsWith("b: outliers in "));
  for (std::uint64_t seed = 2; seed < 6; ++seed)
    CHECK(bench.fuse_log(honest_log(seed), "minque", kept).warnings.find("sensor_apart") == nullptr);
}

TEST_CASE(
    "fuse: a sensor of three that reads otherwise is in the standard deviation of methods that withstand it too") {
  HonestBench bench("", 3);
  using Spoil = double (*)(double, int);
  const std::pair<const char*, Spoil> kinds[] = {{"offset", [](double y, int) { return y + 0.6; }},
                                                 {"sign", [](double y, int) { return -y; }},
                                                 {"ramp", [](double y, int k) { return y + 1e-4 * k; }}};
  for (const auto& [kind, spoil] : kinds)
    for (const char* algorithm : {"minque", "neural-simplex"}) {
      INFO(kind << ", " << algorithm);
      KeptColumns kept;
      bench.fuse_log(honest_log(7, spoil), algorithm, kept);
      CHECK(coverage(kept) >= 0.91);
    }
}

TEST_CASE("fuse: that one of two sensors reads otherwise is told, and either may be wrong in the standard deviation") {
  using Spoil = double (*)(double, int);
  const std::pair<const char*, Spoil> kinds[] = {
      {"offset", [](double y, int) { return y + 0.6; }},
      {"sign", [](double y, int) { return -y; }},
      {"noise", [](double y, int k) { return y + (k % 2 == 0 ? 1 : -1); }},
      {"from the middle", [](double y, int k) { return k < 6000 ? y : y + 2; }}};
  for (const char* algorithm : {"mean", "least-squares"}) {
    HonestBench bench("", 2);
    KeptColumns kept;
    CHECK(bench.fuse_log(honest_log(7), algorithm, kept).warnings.find("sensor_changed") == nullptr);
    for (const auto& [kind, spoil] : kinds) {
      INFO(kind << ", " << algorithm);
      KeptColumns spoilt;
      const FuseResult result = bench.fuse_log(honest_log(7, spoil), algorithm, spoilt);
      const Finding* found = result.warnings.find("sensor_changed");
      REQUIRE(found != nullptr);
      CHECK_THAT(found->where.rows.at(0),
                 StartsWith("a or b: up to ") && Contains(" apart, ") && Contains("to the end"));
      CHECK(coverage(spoilt) >= 0.9);
    }
  }
}

/// A log in which b is a, times `scale` and shifted.
std::string with_copy(const std::string& log, double scale, double shift) {
  std::string out;
  for (std::string_view rest = log, line; !rest.empty();) {
    line = rest.substr(0, rest.find('\n') + 1);
    rest.remove_prefix(line.size());
    const std::size_t a = line.find(',') + 1, b = line.find(',', a) + 1, c = line.find(',', b);
    const std::string cell(line.substr(a, b - 1 - a));
    const bool head = line.starts_with('t');
    out += std::string(line.substr(0, b)) +
           (head ? std::string(line.substr(b, c - b)) : shortest(scale * std::stod(cell) + shift)) +
           std::string(line.substr(c));
  }
  return out;
}

TEST_CASE("fuse: a channel that repeats another one is told, and left out where the method can do without") {
  for (const char* method : {"minque", "mean", "least-squares", "inverse-variance"}) {
    HonestBench bench;
    KeptColumns kept;
    INFO(method);
    CHECK(bench.fuse_log(honest_log(3), method, kept).warnings.find("copied_sensor") == nullptr);
    for (const auto& [scale, shift] : {std::pair{1.0, 0.0}, {1.0, 0.01}, {0.99, 0.02}}) {
      INFO(method << " " << scale << " " << shift);
      KeptColumns again;
      const FuseResult told = bench.fuse_log(with_copy(honest_log(3), scale, shift), method, again);
      REQUIRE(told.warnings.find("copied_sensor") != nullptr);
      CHECK_THAT(told.warnings.find("copied_sensor")->where.rows.at(0), StartsWith("b repeats a"));
      CHECK_THAT(told.warnings.find("copied_sensor")->sentence, Contains("left out"));
      CHECK(told.sensors[1].missing == static_cast<std::uint64_t>(kHonestRows));
      if (std::string_view(method) == "least-squares") continue;  // no deviation without one of the sensors
      CHECK(coverage(again) >= 0.9);
      CHECK(coverage(again) <= 0.975);
    }
  }
}

TEST_CASE("fuse: a sensor that failed is in the standard deviation where it does not show, as weights remember it") {
  const double usual = 0.05;
  const LearntSensor::Reading reading{0, 0, 0.1 * usual, usual};
  detail::SensorDoubt doubt({reading, reading, reading});
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(3, 3000);
  y.row(1).head(500).setConstant(2);  // and then it agrees with the others again
  Eigen::VectorXd estimates = Eigen::VectorXd::Constant(3000, 0.3);
  const auto& variances = doubt.push(y, estimates);
  CHECK(variances[2999].more == Approx(0.09).epsilon(0.01));
  CHECK(variances[2999].least == Approx(usual * usual / 2));
  detail::SensorDoubt sound({reading, reading, reading});
  CHECK(sound.push(Eigen::MatrixXd::Zero(3, 3000), estimates)[2999].more == 0);
}

TEST_CASE("fuse: a sensor that fails puts no sound one in doubt, and no usual distance in the standard deviation") {
  // Of three, four and six one fails: the median moves with it. The estimate follows the past too, off by its noise.
  for (const Eigen::Index n : {3, 4, 6}) {
    INFO(n);
    test::Gaussian gauss(5);
    const LearntSensor::Reading reading{0, 0, 0.01, 0.1};
    const detail::Readings readings(static_cast<std::size_t>(n), reading);
    const double sd = 0.1 / std::sqrt(static_cast<double>(n));
    Eigen::MatrixXd y(n, 6000);
    for (double& one : y.reshaped()) one = 0.1 * gauss();
    detail::UsualEstimates usual;
    std::vector<Eigen::VectorXd> samples;
    for (Eigen::Index k = 0; k < 500; ++k) {
      usual.note(0.5 * y.col(k).mean(), 0.25 * sd * sd);
      samples.emplace_back(y.col(k));
    }
    const auto found = usual.result(readings, samples, 1);
    REQUIRE(found);
    CHECK(found->distance == Approx(0.5 * sd).epsilon(0.1));
    CHECK(found->sd == Approx(0.5 * sd));
    y.row(1).tail(5000).array() += 2;
    detail::SensorDoubt doubt(readings, found);
    const Eigen::VectorXd estimates = 0.5 * (y.colwise().sum() - y.row(1)).transpose() / static_cast<double>(n - 1);
    const auto& variances = doubt.push(y, estimates);
    double sum = 0;
    for (std::size_t k = 2000; k < 6000; ++k) sum += variances[k].of(0.25 * sd * sd) / 4000;
    const double left = 0.5 * 0.1 / std::sqrt(static_cast<double>(n - 1));
    CHECK(std::sqrt(sum) >= 0.95 * left);
    CHECK(std::sqrt(sum) <= 1.25 * left);
  }
}

TEST_CASE(
    "fuse: where fewer than two sensors read as they were learnt to, any may be right in the standard deviation") {
  const LearntSensor::Reading reading{0, 0, 0.005, 0.05};
  const Eigen::VectorXd estimates = Eigen::VectorXd::Zero(3000);
  Eigen::MatrixXd moved(4, 3000), scattered(4, 3000);
  test::Gaussian gauss(6);
  for (Eigen::Index k = 0; k < 3000; ++k)
    for (Eigen::Index i = 0; i < 4; ++i) {
      moved(i, k) = 0.05 * gauss() + (i >= 2 ? 1 : 0);  // the median lies between them
      scattered(i, k) = 0.3 * gauss();
    }
  detail::SensorDoubt two({reading, reading, reading, reading});
  CHECK(two.push(moved, estimates)[2999].more == Approx(1).epsilon(0.3));
  // What scatters only leaves the median right.
  detail::SensorDoubt all({reading, reading, reading, reading});
  const auto& variances = all.push(scattered, estimates);
  double more = 0;
  for (std::size_t k = 1000; k < 3000; ++k) more += variances[k].more / 2000;
  CHECK(std::sqrt(more) == Approx(0.3 * 0.546).epsilon(0.1));  // median of four normal values
}

TEST_CASE(
    "fuse: a sensor that began to fail where this was learnt is told as it was before, and by what was found there") {
  using Spoil = double (*)(double, int);
  const Spoil late = [](double y, int k) { return k < 8000 ? y : y + 0.6; };
  const Spoil always = [](double y, int) { return y + 0.6; };
  for (const bool three : {false, true})
    for (const char* algorithm : {"minque", "least-squares"}) {
      INFO(three << " " << algorithm);
      HonestBench bench("", three ? 3 : 4, late);
      KeptColumns kept;
      const FuseResult result = bench.fuse_log(honest_log(7, always), algorithm, kept);
      const Finding *before = result.warnings.find("sensor_failing"), *now = result.warnings.find("sensor_changed");
      REQUIRE(before != nullptr);
      CHECK_THAT(before->sentence, StartsWith("where this was learnt: "));
      CHECK_THAT(before->where.rows.at(0), StartsWith("b"));
      REQUIRE(now != nullptr);
      CHECK_THAT(now->where.rows.at(0), Contains("b: up to 0.") && Contains("from the start to the end"));
      CHECK(coverage(kept) >= 0.9);
    }
}

TEST_CASE(
    "fuse: where a sensor reads otherwise, the standard deviation of methods that follow it covers what it does") {
  HonestBench bench;
  using Spoil = double (*)(double, int);
  const std::pair<const char*, Spoil> kinds[] = {
      {"offset", [](double y, int) { return y + 2; }},
      {"sign", [](double y, int) { return -y; }},
      {"from the middle", [](double y, int k) { return k < 6000 ? y : y + 5; }}};
  for (const auto& [kind, spoil] : kinds)
    for (const char* algorithm : {"least-squares", "inverse-variance"}) {
      INFO(kind << ", " << algorithm);
      KeptColumns kept;
      bench.fuse_log(honest_log(7, spoil), algorithm, kept);
      CHECK(coverage(kept) >= 0.9);
      CHECK(coverage(kept) < 1);
    }
}
