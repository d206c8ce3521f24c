// Alignment as a stage of a replay: what algorithms are given, and what the report says of it.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "libchar/scene/scene_file.hpp"
#include "tests/replay/kept_columns.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

// Three sensors, the second 0.4 samples late with 3 % too much gain, the third with an offset.
std::string three_sensors(int rows) {
  std::string text = "t[s],a[deg/s],b[deg/s],c[deg/s],x[deg/s]\n";
  const auto motion = [](double t) {
    return 3 * std::sin(0.31 * t) + 2 * std::sin(0.123 * t + 1) + std::sin(0.0471 * t);
  };
  unsigned state = 1;
  const auto noise = [&] {
    state = state * 1664525U + 1013904223U;
    return 0.02 * (static_cast<double>(state >> 8U) / 8388608.0 - 1);
  };
  for (int k = 0; k < rows; ++k) {
    const double a = motion(k) + noise(), b = 1.03 * motion(k - 0.4) + noise();
    const double c = motion(k) + 0.5 + noise();
    text += std::to_string(0.01 * k) + "," + std::to_string(a) + "," + std::to_string(b) + "," + std::to_string(c) +
            "," + std::to_string(motion(k)) + "\n";
  }
  return text;
}

struct AlignedBench {
  AlignedBench() { bench.put("three.csv", three_sensors(4000)); }
  ReplayResult run(const std::string& more, std::size_t block = 0, bool no_skip = false) const {
    const Scene scene = bench.read("format: scene\nversion: 1\nrecording: three.csv\nsensors: [a, b, c]\n" + more);
    ReplayOptions options;
    options.algorithms = {{"mean", {}}};
    options.block = block;
    options.no_skip = no_skip;
    return replay(scene, options);
  }
  test::SceneBench bench;
};

}  // namespace

TEST_CASE("align: taught by the reference, the mean of the sensors is as good as their noise") {
  const AlignedBench bench;
  const std::string taught = "reference: x\nalign: {learn: [0, 15]}\nevaluation: [16, end]\n";
  const ReplayResult aligned = bench.run(taught);
  const ReplayResult recorded = bench.run("reference: x\nevaluation: [16, end]\n");
  REQUIRE(aligned.alignment);
  CHECK_FALSE(recorded.alignment);
  const auto& channels = aligned.alignment->learnt.channels;
  CHECK(channels[1].delay == Approx(0.4).margin(0.01));
  CHECK(channels[1].gain == Approx(0.03).margin(0.001));
  CHECK(channels[2].bias == Approx(0.5).margin(0.002));
  CHECK(aligned.algorithms[0].rmse < 0.02 / 3 * 1.1);
  CHECK(recorded.algorithms[0].rmse > 0.1);
  CHECK(aligned.alignment->budget.before == Approx(recorded.algorithms[0].rmse).epsilon(0.02));
  CHECK(aligned.alignment->budget.after == Approx(aligned.algorithms[0].rmse).epsilon(0.02));
  REQUIRE(aligned.warnings.list().size() == 1);
  CHECK(aligned.warnings.list()[0].code == "sensor_apart");
  CHECK(aligned.warnings.list()[0].where.rows.at(0) == "c: offset 0.5 deg/s");
}

TEST_CASE("align: the same bits for any size of block, with and without skipping") {
  const AlignedBench bench;
  const std::string blind = "align: {learn: [0, 15]}\nevaluation: [16, end]\n";
  const ReplayResult one = bench.run(blind, 1), many = bench.run(blind, 1000), all = bench.run(blind, 0, true);
  CHECK(one.algorithms[0].rmse == many.algorithms[0].rmse);
  CHECK(one.algorithms[0].rmse == all.algorithms[0].rmse);
  CHECK(one.alignment->learnt.channels[1].delay == many.alignment->learnt.channels[1].delay);
  CHECK(one.alignment->budget.after == many.alignment->budget.after);
}

TEST_CASE("align: reported only, the sensors are fused as recorded") {
  const AlignedBench bench;
  const ReplayResult only = bench.run("align: {learn: [0, 15], apply: false}\nevaluation: [16, end]\n");
  for (const SensorResult& sensor : only.sensors) CHECK(sensor.offset == 0);
  CHECK(only.algorithms[0].rmse == Approx(only.alignment->budget.before).epsilon(0.1));
  CHECK(only.alignment->budget.after < 0.1 * only.alignment->budget.before);
}

TEST_CASE("align: learnt and judged on the same stretch is warned of, other windows are refused") {
  const AlignedBench bench;
  const ReplayResult same = bench.run("align: {learn: run}\n");
  CHECK(same.alignment->overlaps);
  CHECK_FALSE(same.warnings.empty());
  CHECK_THROWS_WITH(bench.run("align: {learn: [100, 120]}\n"), Catch::Contains("E0903"));
  CHECK_THROWS_WITH(bench.run("align: {learn: [0, 0.5]}\n"), Catch::Contains("E0911"));
  const Scene two = bench.bench.read(
      "format: scene\nversion: 1\nrecording: three.csv\n"
      "sensors: [{name: a, h: [1, 0]}, {name: b, h: [0, 1]}, {name: c, h: [1, 1]}]\n"
      "reference: [x, a]\nalign: {learn: run}\n");
  CHECK_THROWS_WITH(replay(two), Catch::Contains("E0911"));
}

TEST_CASE("align: the report has the terms and the budget, and the scene is written as it was read") {
  const AlignedBench bench;
  const ReplayResult result = bench.run(
      "align: {learn: [0, 15], terms: [delay, gain], interpolation: cubic, by: sensors}\n"
      "evaluation: [16, end]\n");
  const Json json = replay_json(result)["alignment"];
  CHECK(json["interpolation"] == "cubic");
  CHECK(json["sensors"].size() == 3);
  CHECK(json["sensors"][1]["gain"]["standard_error"].get<double>() > 0);
  CHECK(json["sensors"][1]["bias"]["value"] == 0);
  double sum = 0;
  for (const auto& part : json["budget"]["sensors"][1]["parts"]) sum += part["share"].get<double>();
  CHECK(sum == Approx(1));
  CHECK(replay_markdown(result).find("## Error budget") != std::string::npos);
  const std::string written = scene_yaml(result.scene);
  CHECK(scene_yaml(bench.bench.read(written, "again.yaml")) == written);
}

TEST_CASE("align: weights are those of the run, and instants where delayed sensors have ended are cut") {
  test::SceneBench bench;
  std::string text = "t[s],a,b,c,x\n";
  test::Gaussian gauss(3);
  const auto motion = [](double t) { return std::sin(0.04 * t) + 2 * std::sin(0.011 * t + 1); };
  for (int k = 0; k < 6000; ++k)
    text += fmt::format("{},{},{},{},{}\n", 0.01 * k, motion(k - 5.4) + 0.01 * gauss(),
                        motion(k + 1.3) + 0.02 * gauss(), motion(k) + 0.1 * gauss(), motion(k));
  bench.put("log.csv", text);
  const Scene scene = bench.read(
      "format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b, c]\nreference: x\n"
      "align: {learn: [0, 20]}\nalgorithms: [minque, mean, best-axes]\nlearning: [0, 20]\n"
      "evaluation: [20, end]\n");
  KeptColumns kept;
  ReplayWorkspace workspace;
  workspace.estimates = &kept;
  const ReplayResult result = replay(scene, {}, no_progress(), workspace);
  for (const AlgorithmResult& a : result.algorithms) {
    if (a.weights.empty()) continue;
    CHECK(a.weights[0][0] + a.weights[0][1] + a.weights[0][2] == Approx(1).epsilon(1e-12));
    if (a.label == "minque") {
      CHECK(a.weights[0][0] == Approx(0.72).margin(0.08));
      CHECK(a.weights[0][2] == Approx(0.008).margin(0.005));
    }
    CHECK(a.faults.empty());
  }
  // Samples of the first sensor end 5.4 instants before those of the third: no estimate by fewer.
  const std::vector<double>& mean = kept.of("mean");
  const auto last = [&](std::size_t back) { return mean[mean.size() - back]; };
  for (std::size_t back = 1; back <= 6; ++back) CHECK(std::isnan(last(back)));
  CHECK(std::isfinite(last(7)));
  CHECK(result.algorithms[1].availability > 0.998);
}
