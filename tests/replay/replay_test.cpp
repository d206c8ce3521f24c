#include "libchar/replay/replay.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numeric>

#include "libchar/replay/detail/align/instants.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;
using Catch::Contains;
using test::named;
using test::numbers;

namespace {

std::string array_scene(std::size_t samples, const std::string& more) {
  std::string text =
      "format: scene\nversion: 1\nname: array\nsimulate:\n  rate_hz: 100\n  samples: " + std::to_string(samples) +
      "\n  seed: 5\n  truth: {kind: noise, standard_deviation: 2, bandwidth_hz: 3}\nsensors:\n";
  const char* levels[] = {"3e-3", "4e-3", "5e-3", "6e-3", "7e-3", "8e-3"};
  for (int i = 0; i < 6; ++i)
    text += "  - {name: g" + std::to_string(i + 1) +
            ", model: {unit: rad/s, rate_hz: 100, density: two-sided, white_noise: {value: " + levels[i] + "}}}\n";
  return text + more;
}

}  // namespace

TEST_CASE("replay: the RMSE of the mean is that of a loop over the samples") {
  const test::SceneBench bench;
  const Scene scene = bench.read(array_scene(5000, "algorithms: [mean, inverse-variance]\n"));
  double squares = 0;
  std::int64_t count = 0;
  const Instants instants(scene, no_progress());
  instants.pass(0, 5000, 100, no_progress(), [&](const InstantBlock& b) {
    for (Eigen::Index k = 0; k < b.samples.cols(); ++k, ++count)
      squares += std::pow(b.samples.col(k).mean() - b.truth(0, k), 2);
  });
  const ReplayResult result = replay(scene);
  REQUIRE(count == 5000);
  CHECK(named(result, "mean").rmse == Approx(std::sqrt(squares / 5000)).epsilon(1e-12));
  CHECK(result.algorithms.size() == 2);
  // Q^2 rate, weights by inverse variance: the optimum of this scene.
  double information = 0;
  for (const double q : {3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3}) information += 1 / (q * q * 100);
  CHECK(result.inputs[0].optimum_rmse == Approx(1 / std::sqrt(information)).epsilon(0.03));
  CHECK(named(result, "inverse-variance").regret >= -1e-9);
  CHECK(named(result, "inverse-variance").regret < 0.005);
  CHECK(named(result, "mean").regret == Approx(0.238).margin(0.03));
  CHECK(result.best == std::size_t{1});
  CHECK_FALSE(named(result, "mean").as_good_as_best);
  CHECK(result.sensors[2].error.rmse == Approx(5e-2).epsilon(0.05));
}

TEST_CASE("replay: what needs a reference is trained in its window and scored behind it") {
  const test::SceneBench bench;
  const Scene scene = bench.read(array_scene(6000, "learning: [0, 20]\nalgorithms: [least-squares, mean]\n"));
  const ReplayResult result = replay(scene);
  CHECK(result.instants == 4000);
  CHECK(result.start_s == 20);
  const AlgorithmResult& trained = named(result, "least-squares");
  REQUIRE(trained.ran);
  CHECK(trained.regret < 0.02);
  REQUIRE(trained.weights.size() == 1);
  CHECK(std::accumulate(trained.weights[0].begin(), trained.weights[0].end(), 0.0) == Approx(1).epsilon(1e-12));
  CHECK(trained.weight_distance < 0.1);
  CHECK(result.work.learnt == 2000 + 2 * 4000);  // it, and the two bounds that tell the optimum
  CHECK(trained.learning_s > 0);
}

TEST_CASE("replay: nothing is learnt that nobody needs") {
  const test::SceneBench bench;
  const Scene scene = bench.read(array_scene(3000, "learning: [0, 10]\nalgorithms: [mean]\n"));
  const auto plan = explain_replay(scene);
  const auto said = [&](const std::string& sentence) {
    return std::any_of(plan.begin(), plan.end(),
                       [&](const std::string& s) { return s.find(sentence) != std::string::npos; });
  };
  CHECK(said("the learning window is not read"));
  const ReplayResult lean = replay(scene);
  ReplayOptions options;
  options.no_skip = true;
  const ReplayResult full = replay(scene, options);
  CHECK(full.work.passes > lean.work.passes);
  CHECK(full.work.steps > 5 * lean.work.steps);
  CHECK(full.work.blind_steps > 0);
  CHECK(lean.work.blind_steps == 0);
  CHECK(numbers(full) == numbers(lean));
}

TEST_CASE("replay: without skipping the numbers of all algorithms are the same") {
  const test::SceneBench bench;
  const Scene scene = bench.read(
      array_scene(4000, "learning: [0, 10]\nfaults: [{sensor: g1, kind: scale, value: 0.5, from_s: 25, to_s: 35}]\n"));
  ReplayOptions options;
  options.no_skip = true;
  CHECK(numbers(replay(scene, options)) == numbers(replay(scene)));
}

TEST_CASE("replay: scores do not depend on the block size") {
  const test::SceneBench bench;
  const Scene scene = bench.read(
      array_scene(4000, "learning: [0, 10]\nfaults: [{sensor: g1, kind: bias, value: 3, from_s: 25, to_s: 30}]\n"));
  ReplayOptions options;
  const ReplayResult standard = replay(scene);
  for (const std::size_t block : {1, 37, 100000}) {
    options.block = block;
    const ReplayResult other = replay(scene, options);
    for (std::size_t k = 0; k < standard.algorithms.size(); ++k) {
      INFO(standard.algorithms[k].label << " in blocks of " << block);
      const AlgorithmResult &a = standard.algorithms[k], &b = other.algorithms[k];
      CHECK(a.why == b.why);
      if (!a.ran) continue;
      CHECK(a.rmse == b.rmse);
      CHECK(a.inputs[0].error.maximum == b.inputs[0].error.maximum);
      REQUIRE(a.faults.size() == b.faults.size());
      for (std::size_t f = 0; f < a.faults.size(); ++f) CHECK(a.faults[f].from_s == b.faults[f].from_s);
    }
  }
}

TEST_CASE("replay: faults that the scene knows are answered") {
  const test::SceneBench bench;
  const Scene scene = bench.read(array_scene(12000,
                                             "faults: [{sensor: g2, kind: bias, value: 5, from_s: 60, to_s: 80}]\n"
                                             "algorithms: [minque, mean]\n"));
  const ReplayResult result = replay(scene);
  const AlgorithmResult& minque = named(result, "minque");
  REQUIRE(minque.answers.size() == 1);
  REQUIRE(minque.answers[0].found_s);
  CHECK(*minque.answers[0].found_s < 0.1);
  REQUIRE(minque.answers[0].returned_s);
  CHECK(*minque.answers[0].returned_s > 0);
  CHECK(*minque.answers[0].returned_s < 20);
  CHECK_FALSE(named(result, "mean").watches_faults);
  CHECK(minque.rmse < 0.2 * named(result, "mean").rmse);
  CHECK_FALSE(minque.weight_track.empty());
  CHECK(named(result, "mean").weight_track.empty());
}

TEST_CASE("replay: intervals know when sensors fail, behind a warm-up too") {
  const test::SceneBench bench;
  const std::string fault = "faults:\n  - {sensor: g1, kind: scale, value: 0, from_s: 50}\nalgorithms: [mean]\n";
  for (const char* warm_up : {"", "warm_up_s: 20\n"}) {
    const ReplayResult result = replay(bench.read(array_scene(10000, fault + warm_up)));
    const AlgorithmResult& mean = named(result, "mean");
    CHECK(mean.rmse_ci95.high / mean.rmse_ci95.low < 1.2);
  }
}

TEST_CASE("replay: no reference, leave-one-out and split arrays of equal sensors") {
  const test::SceneBench bench;
  std::string log = "t[s],a,b,c,d,e,f\n";
  std::uint64_t state = 1;
  const auto uniform = [&] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11U) / 9007199254740992.0 - 0.5;
  };
  for (int k = 0; k < 20000; ++k) {
    log += std::to_string(k * 0.01);
    for (int i = 0; i < 6; ++i) log += "," + std::to_string(std::sin(0.01 * k) + uniform());
    log += "\n";
  }
  bench.put("array.csv", log);
  const Scene scene = bench.read("format: scene\nversion: 1\nrecording: array.csv\nsensors: [a, b, c, d, e, f]\n");
  const ReplayResult result = replay(scene);
  const AlgorithmResult& mean = named(result, "mean");
  REQUIRE(mean.blind);
  const double sigma = std::sqrt(1.0 / 12);
  CHECK(mean.blind->leave_one_out_rms == Approx(sigma * std::sqrt(1 + 1.0 / 5)).epsilon(0.01));
  CHECK(mean.blind->split_rms == Approx(sigma / std::sqrt(6.0)).epsilon(0.02));
  CHECK(mean.rmse == mean.blind->predictive_rms);
  CHECK(mean.rmse == Approx(mean.blind->leave_one_out_rms).epsilon(1e-3));  // equal sensors
  CHECK(mean.inputs.empty());
  CHECK(std::isnan(mean.regret));
  CHECK(mean.blind->leave_one_out_ci95.low < mean.rmse);
  CHECK_THAT(named(result, "least-squares").why, Contains("learns from a reference"));
  CHECK_THAT(named(result, "inverse-variance").why, Contains("noise level"));
}

TEST_CASE("replay: a rest gives offsets and noise levels") {
  const test::SceneBench bench;
  std::string log = "t[s],a,b,c\n";
  for (int k = 0; k < 3000; ++k) {
    const double x = k < 1000 ? 0 : std::sin(0.01 * k), e = k % 2 == 0 ? 1 : -1;
    log += std::to_string(k * 0.01) + "," + std::to_string(x + 5 + 0.1 * e) + "," + std::to_string(x - 3 - 0.2 * e) +
           "," + std::to_string(x + 0.4 * e) + "\n";
  }
  bench.put("array.csv", log);
  const Scene scene = bench.read(
      "format: scene\nversion: 1\nrecording: array.csv\nsensors: [a, b, c]\nrest: [0, 10]\n"
      "evaluation: [10, end]\nalgorithms: [inverse-variance]\n");
  const ReplayResult result = replay(scene);
  CHECK(result.sensors[0].offset == Approx(5));
  CHECK(result.sensors[1].offset == Approx(-3));
  CHECK(*result.sensors[1].noise_variance == Approx(0.08));
  REQUIRE(named(result, "inverse-variance").weights.size() == 1);
  CHECK(named(result, "inverse-variance").weights[0][0] == Approx(1 / (1 + 0.25 + 0.0625)));
}

TEST_CASE("replay: two inputs, each with its own scores and optimum") {
  const test::SceneBench bench;
  std::string text =
      "format: scene\nversion: 1\nsimulate:\n  rate_hz: 100\n  samples: 8000\n  truth: [{kind: noise, name: a, "
      "bandwidth_hz: 3}, {kind: noise, name: w, bandwidth_hz: 2}]\nsensors:\n";
  for (int i = 0; i < 6; ++i)
    text += "  - {name: s" + std::to_string(i) + ", h: [1, " + std::to_string(0.1 * i - 0.25) +
            "], model: {unit: m/s^2, density: two-sided, white_noise: {value: " + std::to_string(1e-2 * (i + 1)) +
            "}}}\n";
  const ReplayResult result = replay(bench.read(text));
  const AlgorithmResult& minque = named(result, "minque");
  REQUIRE(minque.ran);
  REQUIRE(minque.inputs.size() == 2);
  CHECK(result.inputs[1].optimum_rmse > result.inputs[0].optimum_rmse);
  CHECK(minque.inputs[0].optimum_ratio == Approx(1).margin(0.05));
  CHECK(minque.inputs[1].optimum_ratio == Approx(1).margin(0.05));
  CHECK(minque.regret < 0.05);
  CHECK_THAT(named(result, "median").why, Contains("one input"));
}

TEST_CASE("replay: an estimated lag aligns sensors and reference") {
  const test::SceneBench bench;
  std::string log = "t[s],a,b,c,x\n";
  for (int k = 0; k < 6000; ++k) {
    const double t = 0.01 * k;
    const auto x = [](double s) { return std::sin(1.7 * s) + 0.7 * std::sin(4.1 * s + 1); };
    log += std::to_string(t);
    for (int i = 0; i < 3; ++i) log += "," + std::to_string(x(t - 0.137));
    log += "," + std::to_string(x(t)) + "\n";
  }
  bench.put("late.csv", log);
  const ReplayResult result =
      replay(bench.read("format: scene\nversion: 1\nrecording: late.csv\nsensors: [a, b, c]\nreference: {channels: "
                        "[x], lag_s: estimate}\nalgorithms: [mean]\n"));
  CHECK(result.lag_estimated);
  CHECK(result.lag_s == Approx(0.137).margin(0.002));
  CHECK(named(result, "mean").rmse < 0.01);
}

TEST_CASE("replay: one algorithm twice with different options has two names") {
  const test::SceneBench bench;
  const ReplayResult result = replay(
      bench.read(array_scene(3000, "algorithms: [{name: minque, gamma: 0.99}, {name: minque, gamma: 0.999}]\n")));
  CHECK(named(result, "minque (gamma=0.99)").ran);
  CHECK(named(result, "minque (gamma=0.999)").ran);
}

TEST_CASE("replay: refusals name the place") {
  const test::SceneBench bench;
  const auto said = [&](const std::string& text, const ReplayOptions& options = {}) -> std::string {
    try {
      replay(bench.read(text), options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const std::string typo = said(array_scene(100, "algorithms:\n  - minqe\n"));
  CHECK_THAT(typo, Contains("did you mean minque?"));
  CHECK_THAT(typo, Contains("s.yaml:"));
  CHECK_THAT(said(array_scene(100, "algorithms: [{name: minque, gama: 0.9}]\n")), Contains("gamma"));
  CHECK_THAT(said(array_scene(100, "algorithms: [mean, mean]\n")), Contains("E0904"));
  CHECK_THAT(said(array_scene(1000, "evaluation: [20, 30]\n")), Contains("after the end"));
  CHECK_THAT(said("format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, bb]\n"), Contains("did you mean b"));
  CHECK_THAT(said("format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b]\nalgorithms: [minque]\n"),
             Contains("E0905"));
  CHECK_THAT(said("format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b]\nreference: zz\n"), Contains("zz"));
}

TEST_CASE("replay: of many sensors without reference some are left out in turn") {
  const test::SceneBench bench;
  std::string head = "t[s]", names;
  for (int i = 0; i < 40; ++i) {
    head += ",s" + std::to_string(i);
    names += (i == 0 ? "s" : ", s") + std::to_string(i);
  }
  std::string log = head + "\n";
  for (int k = 0; k < 300; ++k) {
    log += std::to_string(0.01 * k);
    for (int i = 0; i < 40; ++i) log += "," + std::to_string((k * 7 + i * i * 13) % (17 + i));
    log += "\n";
  }
  bench.put("many.csv", log);
  const ReplayResult result = replay(
      bench.read("format: scene\nversion: 1\nrecording: many.csv\nsensors: [" + names + "]\nalgorithms: [mean]\n"));
  REQUIRE(named(result, "mean").blind);
  const auto& each = named(result, "mean").blind->leave_one_out;
  CHECK(std::count_if(each.begin(), each.end(), [](double v) { return v > 0; }) == 32);
  CHECK(named(result, "mean").rmse > 0);
}

TEST_CASE("replay: a sensor with every second sample takes nothing from the others") {
  const test::SceneBench bench;
  std::string log = "t[s],a,b,c,x\n";
  for (int k = 0; k < 3000; ++k) {
    const double x = std::sin(0.01 * k);
    log += std::to_string(0.01 * k) + "," + std::to_string(x + 0.01 * (k % 3)) + "," +
           std::to_string(x - 0.02 * (k % 5)) + "," + (k % 2 == 0 ? std::to_string(x + 0.01 * (k % 7)) : "") + "," +
           std::to_string(x) + "\n";
  }
  bench.put("half.csv", log);
  const ReplayResult result = replay(bench.read(
      "format: scene\nversion: 1\nrecording: half.csv\nsensors: [a, b, c]\nreference: x\nlearning: [0, 10]\n"));
  CHECK(named(result, "mean").availability == 1);
  CHECK_FALSE(named(result, "mean").inputs[0].allan.points.empty());
  // It needs all three at once, so that no two of its errors follow each other.
  CHECK(named(result, "blind-calibration").availability == 1);
  const AlgorithmResult& whole = named(result, "perceptron");
  REQUIRE(whole.ran);
  CHECK(whole.availability == Approx(0.5).margin(0.01));
  CHECK(whole.inputs[0].allan.points.empty());
}

TEST_CASE("replay: what cannot be scored or does not change is said") {
  const test::SceneBench bench;
  std::string log = "t[s],a,b,c,x\n";
  for (int k = 0; k < 500; ++k) log += std::to_string(0.01 * k) + ",1,1,1," + std::to_string(k) + "\n";
  bench.put("flat.csv", log);
  const std::string scene = "format: scene\nversion: 1\nrecording: flat.csv\nsensors: [a, b, c]\n";
  const ReplayResult result = replay(bench.read(scene));
  REQUIRE(result.warnings.find("constant_sensor") != nullptr);
  CHECK(result.warnings.find("constant_sensor")->count == 3);
  CHECK(named(result, "mean").as_good_as_best);
  CHECK(named(result, "median").as_good_as_best);
  CHECK_THROWS_WITH(replay(bench.read(scene + "reference: {channels: [x], lag_s: 100}\n")), Contains("E0902"));
  const ReplayResult golden = replay(bench.read(scene + "reference: b\n"));
  REQUIRE(golden.warnings.find("reference_is_a_sensor") != nullptr);
  CHECK(golden.warnings.find("reference_is_a_sensor")->count == 1);
}

namespace {

/// Five sensors of a sine at 100 Hz; `cell(sensor, instant)` may replace a sample by text.
std::string five_sensors(int rows, const std::function<std::string(int, int)>& cell) {
  std::string log = "t[s],a[deg/s],b[deg/s],c[deg/s],d[deg/s],e[deg/s],x[deg/s]\n";
  std::uint64_t state = 1;
  const auto noise = [&] {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return static_cast<double>(state >> 11U) * 0x1p-53 - 0.5;
  };
  for (int k = 0; k < rows; ++k) {
    const double x = std::sin(0.02 * k);
    log += fmt::format("{:.2f}", 0.01 * k);
    for (int i = 0; i < 5; ++i) {
      const std::string own = fmt::format("{:.12g}", x + 0.1 * (i + 1) * noise());
      const std::string other = cell(i, k);
      log += "," + (other == "keep" ? own : other);
    }
    log += fmt::format(",{:.12g}\n", x);
  }
  return log;
}

const std::string kFive = "format: scene\nversion: 1\nrecording: five.csv\nsensors: [a, b, c, d, e]\n";

}  // namespace

TEST_CASE("replay: a sensor that dies at once is left out of everything, with a sentence") {
  const test::SceneBench bench;
  const std::string more = "reference: x\nlearning: [0, 20]\n";
  bench.put("five.csv",
            five_sensors(4000, [](int i, int k) { return i == 2 && k > 0 ? std::string() : std::string("keep"); }));
  const ReplayResult dead = replay(bench.read(kFive + more));
  REQUIRE(dead.warnings.find("sensor_without_samples") != nullptr);
  CHECK(dead.warnings.find("sensor_without_samples")->where.rows == std::vector<std::string>{"c"});
  // What the others give is what they give without it, bit for bit.
  bench.put("four.csv", five_sensors(4000, [](int, int) { return std::string("keep"); }));
  const ReplayResult four =
      replay(bench.read("format: scene\nversion: 1\nrecording: four.csv\nsensors: [a, b, d, e]\n" + more));
  int compared = 0;
  for (const AlgorithmResult& algorithm : four.algorithms) {
    if (!algorithm.ran) continue;
    INFO(algorithm.label);
    const AlgorithmResult& same = named(dead, algorithm.label);
    REQUIRE(same.ran);
    CHECK(same.rmse == algorithm.rmse);
    CHECK(same.availability == algorithm.availability);
    if (!same.weights.empty()) CHECK(same.weights[0][2] == 0);
    ++compared;
  }
  CHECK(compared > 12);
  CHECK(dead.inputs[0].optimum_rmse == four.inputs[0].optimum_rmse);
  // Without a reference too.
  const ReplayResult blind = replay(bench.read(kFive));
  CHECK(named(blind, "mean").blind->leave_one_out_rms > 0);
  CHECK(std::isnan(named(blind, "mean").blind->leave_one_out[2]));
}

TEST_CASE("replay: a sensor that freezes is left out of everything, with its place") {
  const test::SceneBench bench;
  bench.put("five.csv", five_sensors(4000, [](int i, int k) {
              return i == 2 && k >= 2000 ? std::string("0.125") : std::string("keep");
            }));
  const ReplayResult frozen = replay(bench.read(kFive));
  REQUIRE(frozen.warnings.find("frozen_sensor") != nullptr);
  CHECK_THAT(frozen.warnings.find("frozen_sensor")->where.rows.at(0), Catch::StartsWith("c from 2"));
  CHECK(std::isnan(named(frozen, "mean").blind->leave_one_out[2]));
  // A fault that the scene puts in is there to be found.
  bench.put("good.csv", five_sensors(4000, [](int, int) { return std::string("keep"); }));
  const ReplayResult put_in =
      replay(bench.read("format: scene\nversion: 1\nrecording: good.csv\nsensors: [a, b, c, d, e]\n"
                        "faults: [{sensor: c, kind: stuck, from_s: 20, to_s: 30}]\n"));
  CHECK(put_in.warnings.find("frozen_sensor") == nullptr);
}

TEST_CASE("replay: a sensor that freezes near the end has its weight until then") {
  const test::SceneBench bench;
  bench.put("five.csv", five_sensors(4000, [](int i, int k) {
              return i == 2 && k >= 3600 ? std::string("0.125") : std::string("keep");
            }));
  const ReplayResult frozen = replay(bench.read(kFive));
  REQUIRE(frozen.warnings.find("frozen_sensor") != nullptr);
  CHECK_THAT(frozen.warnings.find("frozen_sensor")->where.rows.at(0), Catch::StartsWith("c from 3"));
  CHECK(named(frozen, "mean").weights.at(0)[2] == Approx(0.2));
  CHECK(frozen.sensors[2].missing == Approx(0.1));
}

TEST_CASE("replay: a sensor that hangs again and again is missing while it does, beside one other too") {
  const test::SceneBench bench;
  const auto hangs = [](int i, int k) {
    return i == 2 && k % 200 < 20 ? fmt::format("0.{:04}1", k / 200) : std::string("keep");
  };
  bench.put("five.csv", five_sensors(4000, hangs));
  for (const char* const sensors : {"[a, b, c, d, e]", "[a, c]"}) {
    const ReplayResult hung =
        replay(bench.read(fmt::format("format: scene\nversion: 1\nrecording: five.csv\nsensors: {}\n", sensors)));
    REQUIRE(hung.warnings.find("frozen_sensor") != nullptr);
    CHECK(hung.warnings.find("frozen_sensor")->where.rows.at(0) ==
          "c in 20 stretches of 20 samples, 10 % of the recording");
    CHECK(hung.warnings.find("stuck") == nullptr);
    for (const auto& sensor : hung.sensors) CHECK(sensor.missing == Approx(sensor.name == "c" ? 0.1 : 0));
  }
  const ReplayResult taught = replay(bench.read(
      "format: scene\nversion: 1\nrecording: five.csv\nsensors: [a, b, d, e]\nreference: {channels: [c]}\n"));
  REQUIRE(taught.warnings.find("stuck") != nullptr);
  CHECK_THAT(taught.warnings.find("stuck")->where.rows.at(0), Catch::StartsWith("c in 20 stretches"));
}

TEST_CASE("replay: a sensor that repeats another one is named") {
  const test::SceneBench bench;
  bench.put("five.csv", five_sensors(3000, [](int, int) { return std::string("keep"); }));
  const ReplayResult twice =
      replay(bench.read("format: scene\nversion: 1\nrecording: five.csv\nsensors: [a, b, {name: again, channel: a}, "
                        "d]\nreference: x\nalgorithms: [mean, optimal-weights]\n"));
  REQUIRE(twice.warnings.find("copied_sensor") != nullptr);
  CHECK(twice.warnings.find("copied_sensor")->where.rows == std::vector<std::string>{"again repeats a"});
  CHECK_THAT(test::verdict_of(twice, false), Catch::Contains("(again repeats a)"));
  CHECK(twice.sensors[2].copy_of == "a");
  CHECK(twice.sensors[3].copy_of.empty());
  const ReplayResult once =
      replay(bench.read("format: scene\nversion: 1\nrecording: five.csv\nsensors: [a, b, d]\nreference: x\nalgorithms: "
                        "[mean, optimal-weights]\n"));
  for (const char* one : {"mean", "optimal-weights"}) CHECK(named(twice, one).rmse == named(once, one).rmse);
  CHECK(named(twice, "optimal-weights").weights.at(0)[0] == named(once, "optimal-weights").weights.at(0)[0]);
  const ReplayResult two =
      replay(bench.read("format: scene\nversion: 1\nrecording: five.csv\nsensors: [a, {name: again, channel: a}]\n"));
  REQUIRE(two.warnings.find("copied_sensor") != nullptr);
  CHECK_THAT(two.warnings.find("copied_sensor")->sentence, Catch::Contains("counted twice"));
}

TEST_CASE("replay: a sensor that is another one scaled and shifted is left out") {
  const test::SceneBench bench;
  const auto cells = [&](int i, int k) {
    return i == 2   ? fmt::format("{:.9g}", 4 + 2.5 * std::sin(0.3 * k))
           : i == 0 ? fmt::format("{:.9g}", std::sin(0.3 * k))
                    : std::string("keep");
  };
  bench.put("five.csv", five_sensors(3000, cells));
  const ReplayResult twice = replay(bench.read(kFive + "reference: x\nalgorithms: [mean, minque]\n"));
  REQUIRE(twice.warnings.find("copied_sensor") != nullptr);
  CHECK(twice.warnings.find("copied_sensor")->where.rows == std::vector<std::string>{"c repeats a, scaled or shifted"});
  CHECK(twice.sensors[2].copy_of == "a");
}

TEST_CASE("replay: the warm-up runs and is not scored") {
  const test::SceneBench bench;
  bench.put("five.csv", five_sensors(3000, [](int i, int k) {
              return i == 0 && k < 500 ? std::string(k % 2 == 0 ? "100" : "101") : std::string("keep");
            }));
  const std::string scene = kFive + "reference: x\nalgorithms: [mean, median]\n";
  const ReplayResult all = replay(bench.read(scene)), warm = replay(bench.read(scene + "warm_up_s: 5\n"));
  CHECK(named(all, "mean").rmse > 5);
  CHECK(named(warm, "mean").rmse < 0.2);
  CHECK(named(warm, "mean").inputs[0].error.samples == 2500);
  CHECK(warm.sensors[0].error.rmse < 0.1);
  CHECK(named(warm, "mean").availability == 1);
  ReplayOptions options;
  options.block = 7;
  const ReplayResult small = replay(bench.read(scene + "warm_up_s: 5\n"), options);
  CHECK(named(small, "mean").rmse == named(warm, "mean").rmse);
  CHECK(small.sensors[0].error.rmse == warm.sensors[0].error.rmse);
  CHECK(small.inputs[0].optimum_rmse == warm.inputs[0].optimum_rmse);
  CHECK_THROWS_WITH(replay(bench.read(scene + "warm_up_s: 30\n")), Contains("E0903"));
}

TEST_CASE("replay: another scale is another unit") {
  const test::SceneBench bench;
  bench.put("five.csv", five_sensors(300, [](int, int) { return std::string("keep"); }));
  const auto units = [&](const std::string& sensor) {
    return replay(bench.read("format: scene\nversion: 1\nrecording: five.csv\nsensors: [" + sensor +
                             ", b]\nalgorithms: [mean]\n"))
        .sensors[0]
        .unit;
  };
  CHECK(units("a") == "deg/s");
  CHECK(units("{name: a, scale: -1}") == "deg/s");
  CHECK(units("{name: a, scale: 0.0174533}") == "deg/s (× 0.0174533)");
  CHECK(units("{name: a, scale: 0.0174533, unit: rad/s}") == "rad/s");
}

TEST_CASE("replay: samples whose squares vanish are refused, a wild one is not") {
  const test::SceneBench bench;
  for (const char* size : {"1e-150", "1e150"}) {
    bench.put("five.csv", five_sensors(300, [&](int i, int k) {
                return (k + i) % 2 == 0 ? std::string(size) : "-" + std::string(size);
              }));
    CHECK_THROWS_WITH(replay(bench.read(kFive + "algorithms: [mean]\n")), Contains("E0909"));
  }
  bench.put("five.csv", five_sensors(300, [](int i, int k) {
              return i == 1 && k == 50 ? std::string("1e300") : std::string("keep");
            }));
  CHECK_NOTHROW(replay(bench.read(kFive + "algorithms: [mean]\n")));
}
