#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "libchar/replay/fusion_file.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/replay/view/ranking.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;
using Catch::StartsWith;
using test::named;

namespace {

struct Sensor {
  double noise = 1, offset = 0, gain = 1;
  double jump = 0;      ///< of the offset, from six tenths of the log on
  double outliers = 0;  ///< share of samples that are 30 times the noise off
  double louder = 1;    ///< the noise is so many times that, from four tenths of the log on
  double popcorn = 0;   ///< two levels so far apart, for 2 s in the mean
  double gain_end = 0;  ///< what the gain has gained at the end
  double step = 0;      ///< resolution
  double missing = 0;   ///< share of the log at its end without samples
  double recurs = 0;    ///< of the offset, 7 s of 14 from six tenths of the log on
};

// A recording of sensors that see one slow signal, beside the signal itself.
std::string array_log(const std::vector<Sensor>& sensors, std::size_t rows, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  std::string out = "t[s]";
  bool up = false;
  for (std::size_t i = 0; i < sensors.size(); ++i) out += ",s" + std::to_string(i + 1);
  out += ",truth\n";
  for (std::size_t k = 0; k < rows; ++k) {
    const double x = 3 * std::sin(0.003 * static_cast<double>(k)) + std::sin(0.02 * static_cast<double>(k));
    out += std::to_string(static_cast<double>(k) * 0.01);
    char cell[32];
    for (const Sensor& sensor : sensors) {
      const double offset =
          sensor.offset + (10 * k < 6 * rows ? 0 : sensor.jump + (k % 1400 < 700 ? sensor.recurs : 0));
      const double noise = sensor.noise * (10 * k < 4 * rows ? 1 : sensor.louder);
      const double along = static_cast<double>(k) / static_cast<double>(rows);
      double y = (sensor.gain + sensor.gain_end * along) * x + offset;
      y += noise * gauss() * (gauss.uniform() < sensor.outliers ? 30 : 1);
      if (sensor.popcorn > 0) y += sensor.popcorn * (up = up != (gauss.uniform() < 0.005));
      if (sensor.step > 0) y = std::round(y / sensor.step) * sensor.step;
      std::snprintf(cell, sizeof cell, ",%.9g", y);
      out += along >= 1 - sensor.missing ? "," : cell;
    }
    std::snprintf(cell, sizeof cell, ",%.9g\n", x);
    out += cell;
  }
  return out;
}

std::string scene_of(std::size_t sensors, const std::string& more) {
  std::string text = "format: scene\nversion: 1\nrecording: array.csv\nsensors: [";
  for (std::size_t i = 0; i < sensors; ++i) text += (i == 0 ? "s" : ", s") + std::to_string(i + 1);
  return text + "]\n" + more;
}

}  // namespace

TEST_CASE("verdict: whether fusion pays is said against the best single sensor, by name") {
  const test::SceneBench bench;
  bench.put("array.csv", array_log({{1}, {1}, {0.9}, {1}, {1}}, 8000, 1));
  ReplayResult result = replay(bench.read(scene_of(5, "reference: truth\nalgorithms: [mean, median]\n")));
  REQUIRE(result.best_sensor == std::size_t{2});
  CHECK(result.best_over_sensor->high < 0.6);
  CHECK_THAT(test::verdict_of(result, false),
             StartsWith("Use mean") && Contains("Fusion pays") && Contains("below that of s3"));

  bench.put("array.csv", array_log({{1}, {1}, {0.1}, {1}, {1}}, 8000, 2));
  result = replay(bench.read(scene_of(5, "reference: truth\nalgorithms: [mean]\n")));
  CHECK_THAT(test::verdict_of(result, false),
             StartsWith("Fusion does not pay") && Contains(" times that of s3") && Contains("use that sensor alone"));
}

TEST_CASE("verdict: without a reference the method is chosen that is best with one, whatever the worst sensors do") {
  // Two good sensors of seven, gains and noise mixed; the scale of the worst is a hundred times that of the best.
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    const test::SceneBench bench;
    bench.put("array.csv", array_log({{0.05}, {0.07}, {0.5}, {1}, {3}, {5, 0, 0.8}, {5, 0, 1.3}}, 20000, seed));
    const std::string methods = "algorithms: [mean, median, minque]\n";
    const ReplayResult blind = replay(bench.read(scene_of(7, methods)));
    const ReplayResult seen = replay(bench.read(scene_of(7, "reference: truth\n" + methods)));
    REQUIRE(blind.best);
    const std::string chosen = blind.algorithms[*blind.best].label;
    CHECK(named(seen, chosen.c_str()).rmse <= 1.15 * seen.algorithms[*seen.best].rmse);
  }
}

TEST_CASE("verdict: offsets that a short log cannot take out are asked for, not compared") {
  const test::SceneBench bench;
  bench.put("array.csv", array_log({{1, -1000}, {1, 300}, {1, 900}, {1, 0}}, 400, 3));
  ReplayResult result = replay(bench.read(scene_of(4, "algorithms: [mean, median]\n")));
  CHECK(result.offsets_decide);
  CHECK(result.chosen_as_robust);
  REQUIRE(result.best);
  CHECK(result.algorithms[*result.best].label == "median");
  CHECK_THAT(test::verdict_of(result, false),
             StartsWith("Use median") && Contains("Scores do not decide") && Contains("a stretch at rest"));
  result = replay(bench.read(scene_of(4, "algorithms: [mean]\n")));
  CHECK_FALSE(result.best);
  CHECK_THAT(test::verdict_of(result, false), StartsWith("No method is recommended") && Contains("a stretch at rest"));
  result = replay(bench.read(scene_of(4, "rest: [0, 1]\nalgorithms: [mean, median]\n")));
  CHECK_FALSE(result.offsets_decide);
  CHECK(result.best);
}

TEST_CASE("verdict: without a reference offsets are taken out, and the level is stated") {
  const test::SceneBench bench;
  const std::vector<Sensor> sensors = {{0.05, -1}, {0.3, 0.3}, {0.3, 0.9}, {0.3, 0.1}, {0.3, 0.2, 1, 0, 0}, {0.3, 40}};
  bench.put("array.csv", array_log(sensors, 8000, 3));
  const ReplayResult result = replay(bench.read(scene_of(6, "algorithms: [mean, median, minque]\n")));
  REQUIRE(result.level_sd);
  CHECK(*result.level_sd < 0.6);
  CHECK_FALSE(result.offsets_decide);
  REQUIRE(result.best);
  CHECK(result.algorithms[*result.best].label == "minque");
  double level = 0;  // of the five that do not stand apart
  for (std::size_t i = 0; i < 5; ++i) level += sensors[i].offset / 5;
  for (std::size_t i = 0; i < sensors.size(); ++i)
    CHECK(result.sensors[i].offset == Approx(sensors[i].offset - level).margin(0.02));
  CHECK_THAT(test::verdict_of(result, false), Contains("The means of the sensors differ") && Contains("s6: offset 4"));
  REQUIRE(result.learnt.inputs.at(0).level_sd);
  CHECK(parse_fusion_file(fusion_yaml(result.learnt), "fusion.yaml").inputs.at(0).level_sd == result.level_sd);
}

TEST_CASE("verdict: without a reference sensors that stand apart do not move the level") {
  // By 5 times the noise, by half of it, and two of five that agree: those that are near each other are the level.
  const std::vector<std::vector<Sensor>> arrays = {{{1, 0.1}, {1, -0.1}, {1, 0.2}, {1, 5}},
                                                   {{1, 0.01}, {1, -0.01}, {1, 0.02}, {1, 0}, {1, -0.02}, {1, 0.5}},
                                                   {{0.1}, {0.1, 0.501}, {0.1, 0.001}, {0.1, 0.5}, {0.1, -0.001}}};
  for (const std::vector<Sensor>& sensors : arrays) {
    const test::SceneBench bench;
    bench.put("array.csv", array_log(sensors, 20000, 3));
    const ReplayResult result = replay(bench.read(scene_of(sensors.size(), "algorithms: [mean, median]\n")));
    REQUIRE(result.level_sd);
    double level = 0;  // of the mean of the estimates: nothing else is told
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const bool apart = sensors[i].offset > 0.3;
      CHECK(result.sensors[i].offset == Approx(apart ? sensors[i].offset : 0).margin(0.06));
      level += (sensors[i].offset - result.sensors[i].offset) / static_cast<double>(sensors.size());
    }
    CHECK(std::abs(level) < kNormal95 * *result.level_sd);
  }
}

TEST_CASE("verdict: a noisier sensor of an array at rest has no other gain") {
  const test::SceneBench bench;
  for (const double louder : {3.0, 12.0}) {
    std::mt19937_64 random(4);
    std::normal_distribution<double> noise;
    std::string log = "t,s1,s2,s3,s4,s5\n";
    for (int k = 0; k < 8000; ++k) {
      log += fmt::format("{:.2f}", k / 100.0);
      for (int i = 0; i < 5; ++i) log += fmt::format(",{:.5f}", (i == 2 ? louder : 1) * noise(random));
      log += "\n";
    }
    bench.put("array.csv", log);
    const ReplayResult result = replay(bench.read(scene_of(5, "algorithms: [mean, minque]\n")));
    std::string said;
    for (const Finding& one : result.warnings.list())
      for (const std::string& row : one.where.rows) said += row + "\n";
    CAPTURE(louder);
    CHECK_THAT(said, !Contains("gain"));
    if (louder > 10) CHECK_THAT(said, StartsWith("s3: noise 1"));
  }
}

TEST_CASE("verdict: what is known of the reading is said where the method is recommended") {
  const test::SceneBench bench;
  for (const double rate_hz : {4.0, 10.0}) {  // of the second logger
    test::Gaussian noise(2);
    std::string log = "t1[s],s1,t2[s],s2\n";
    for (int k = 0; k < 2000; ++k) {
      const double first = noise(), second = noise();
      log += fmt::format("{:.1f},{:.4f},{:.2f},{:.4f}\n", k / 10.0, first, k / rate_hz, second);
    }
    bench.put("array.csv", log);
    const ReplayResult result = replay(bench.read(scene_of(2, "algorithms: [mean]\n")));
    const bool said =
        test::verdict_of(result, false).find("Repair the samples first (channel with stamps of its own)") !=
        std::string::npos;
    CHECK(said == (rate_hz < 10));
  }
}

TEST_CASE("verdict: a turned sign is named where noise hides gains") {
  const test::SceneBench bench;
  for (const bool turned : {false, true}) {
    test::Gaussian noise(9);
    std::string log = "t,s1,s2,s3\n";
    for (int k = 0; k < 6000; ++k) {
      const double x = std::sin(k / 50.0) + 0.3 * std::sin(k / 17.0);
      log += fmt::format("{:.2f},{:.5f},{:.5f},{:.5f}\n", k / 100.0, x + 0.5 * noise(),
                         (turned ? -x : x) + 0.7 * noise(), x + 0.9 * noise());
    }
    bench.put("array.csv", log);
    const ReplayResult result = replay(bench.read(scene_of(3, "algorithms: [mean, median]\n")));
    std::string said;
    for (const Finding& one : result.warnings.list())
      for (const std::string& row : one.where.rows) said += row + "\n";
    CHECK((said.find("s2: gain -") != said.npos) == turned);
    CHECK((said.find("gain") != said.npos) == turned);
  }
}

TEST_CASE("verdict: without a reference the level is stated also where offsets are too small to be taken out") {
  const test::SceneBench bench;
  // Offsets of 0.3 in noise of 1, by which the mean of four is 0.15 off, and not by 0.01 as 8000 samples would make it.
  bench.put("array.csv", array_log({{1, 0.3}, {1, -0.3}, {1, 0.2}, {1, -0.25}}, 8000, 5));
  for (const char* more : {"", "align: {terms: [bias]}\n"}) {
    const ReplayResult result = replay(bench.read(scene_of(4, std::string("algorithms: [mean, minque]\n") + more)));
    REQUIRE(result.level_sd);
    CHECK(*result.level_sd == Approx(0.15 * 1.62).epsilon(0.3));  // Student's t of four sensors
    for (const SensorResult& sensor : result.sensors) CHECK(sensor.offset == 0);
    CHECK(result.learnt.inputs.at(0).level_sd == result.level_sd);
    CHECK_THAT(test::verdict_of(result, false), Contains("The level is known to ± "));
  }
}

TEST_CASE("verdict: without a reference the gain that sensors share is stated beside the level") {
  const test::SceneBench bench;
  bench.put("array.csv", array_log({{0.1, 0, 1.02}, {0.1, 0, 0.97}, {0.1, 0, 1.05}, {0.1}}, 20000, 5));
  const ReplayResult blind = replay(bench.read(scene_of(4, "algorithms: [mean, minque]\n")));
  REQUIRE(blind.gain_sd);
  REQUIRE(blind.gain_about);
  CHECK(*blind.gain_sd == Approx(0.5 * 0.034 * 1.62).epsilon(0.3));  // Student's t of four sensors
  CHECK(blind.learnt.inputs.at(0).gain_sd == blind.gain_sd);
  CHECK(blind.learnt.inputs.at(0).gain_about == blind.gain_about);
  CHECK_THAT(test::verdict_of(blind, false), Contains("The gain is known to ± "));
  const ReplayResult seen = replay(bench.read(scene_of(4, "reference: truth\nalgorithms: [mean, minque]\n")));
  CHECK_FALSE(seen.gain_sd);
  CHECK_THAT(test::verdict_of(seen, false), !Contains("The gain is known"));
}

TEST_CASE("verdict: a sensor that is louder for most of the log is named") {
  for (const std::size_t n : {3U, 4U, 6U}) {
    std::vector<Sensor> sensors(n, Sensor{0.1});
    sensors[1].louder = 10;
    const test::SceneBench bench;
    bench.put("array.csv", array_log(sensors, 20000, n));
    const ReplayResult result = replay(bench.read(scene_of(n, "algorithms: [mean, median]\n")));
    const Finding* failing = result.warnings.find("sensor_failing");
    REQUIRE(failing != nullptr);
    CHECK(failing->count == 1);
    CHECK_THAT(failing->where.rows.at(0), StartsWith("s2") && Contains("from the start to 79.4 s"));
  }
}

TEST_CASE("verdict: what one sensor does throughout is named, or said to be untold where few sensors see it") {
  const std::pair<const char*, Sensor> kinds[] = {{"scatter", {.noise = 0.1, .popcorn = 0.6}},
                                                  {"its gain drifts from ", {.noise = 0.1, .gain_end = -0.2}},
                                                  {"of its samples repeat", {.noise = 0.1, .step = 1}},
                                                  {"gain 1.", {.noise = 0.1, .gain = 1.2}},
                                                  {"noise", {.noise = 1}},
                                                  {"offset", {.noise = 0.1, .offset = 1}},
                                                  {"up to ", {.noise = 0.1, .recurs = 0.8}},
                                                  {"outliers in ", {.noise = 0.1, .outliers = 0.002}},
                                                  {" of the instants", {.noise = 0.1, .missing = 0.3}}};
  for (const auto& [words, fault] : kinds)
    for (const std::size_t n : {3U, 4U, 6U, 12U})
      for (const char* reference : {"", "reference: truth\n"}) {
        INFO(words << " of " << n << " " << reference);
        std::vector<Sensor> sensors(n, Sensor{0.1});
        sensors[1] = fault;
        sensors[2].noise = 0.2;
        const test::SceneBench bench;
        bench.put("array.csv", array_log(sensors, 20000, n));
        const ReplayResult result =
            replay(bench.read(scene_of(n, std::string("algorithms: [mean, median]\n") + reference)));
        const std::string verdict = test::verdict_of(result, false);
        const std::size_t doubts =
            std::min({verdict.find("Caution"), verdict.find("Not decidable"), verdict.find("Samples are missing")});
        REQUIRE(doubts != std::string::npos);
        CHECK_THAT(verdict.substr(doubts), Contains("s2") && Contains(words));
        for (const char* code : {"sensor_failing", "sensor_apart", "sensor_unlike"})
          if (const Finding* found = result.warnings.find(code)) CHECK(found->count == 1);
      }
}

TEST_CASE("verdict: that one of two sensors fails is said, and which where there is a reference") {
  const Sensor kinds[] = {{.noise = 0.1, .jump = 2}, {.noise = 0.1, .louder = 10}, {.noise = 0.1, .gain_end = -0.5}};
  for (const Sensor& fault : kinds)
    for (const bool reference : {false, true}) {
      INFO(&fault - kinds << (reference ? ", reference" : ""));
      const test::SceneBench bench;
      bench.put("array.csv", array_log({{0.1}, fault}, 20000, 5));
      const std::string scene =
          scene_of(2, reference ? "algorithms: [mean]\nreference: truth\n" : "algorithms: [mean]\n");
      const ReplayResult result = replay(bench.read(scene));
      const Finding* failing = result.warnings.find("sensor_failing");
      if (!reference && fault.gain_end != 0) continue;  // of two, a motion that both follow unlike
      REQUIRE(failing != nullptr);
      CHECK(failing->count == 1);
      CHECK_THAT(failing->where.rows.at(0), StartsWith(reference ? "s2: " : "s1 or s2: up to "));
    }
  // A sensor of another gain or sign throughout: only the reference tells.
  for (const double gain : {-1., 1.4, 57.3}) {
    INFO(gain);
    const test::SceneBench bench;
    bench.put("array.csv", array_log({{0.1}, {0.1, 0, gain}}, 20000, 5));
    const ReplayResult result = replay(bench.read(scene_of(2, "algorithms: [mean]\nreference: truth\n")));
    const Finding* apart = result.warnings.find("sensor_apart");
    REQUIRE(apart != nullptr);
    CHECK(apart->count == 1);
    CHECK_THAT(apart->where.rows.at(0), StartsWith("s2: gain "));
  }
  // Sound ones, of noise, offsets and gains of their own, or one of them better: nothing is said of them.
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const char* reference : {"", "reference: truth\n"}) {
      INFO(seed << " " << reference);
      const test::SceneBench bench;
      bench.put("array.csv", array_log({{0.1, 0.2, 1.01}, {seed % 2 == 0 ? 0.02 : 0.1, -0.1, 0.99}}, 20000, seed));
      const ReplayResult result = replay(bench.read(scene_of(2, std::string("algorithms: [mean]\n") + reference)));
      CHECK(result.warnings.find("sensor_failing") == nullptr);
      CHECK(result.warnings.find("sensor_apart") == nullptr);
    }
}

TEST_CASE("verdict: sensors that are late or early beside the others are named where no alignment looked for delays") {
  const auto log = [](std::vector<double> late, double noise) {
    test::Gaussian gauss(3);
    std::string out = "t[s]";
    for (std::size_t i = 0; i < late.size(); ++i) out += fmt::format(",s{}", i + 1);
    for (int k = 0; k < 8000; ++k) {
      out += fmt::format("\n{}", k * 0.01);
      for (const double by : late)
        out += fmt::format(",{}", std::sin(0.2 * (k - by)) + std::sin(0.031 * (k - by)) + noise * gauss());
    }
    return out + "\n";
  };
  const test::SceneBench bench;
  for (const double noise : {0.02, 0.1}) {
    INFO(noise);
    bench.put("array.csv", log({0, 0, 1.5, -1.5}, noise));
    const std::string methods = "algorithms: [mean, median]\n";
    const ReplayResult result = replay(bench.read(scene_of(4, methods)));
    const Finding* found = result.warnings.find("sensors_out_of_time");
    REQUIRE(found != nullptr);
    CHECK(found->count >= 2);
    CHECK_THAT(test::verdict_of(result, false),
               Contains("s3: ") && Contains(" samples late") && Contains("s4: ") && Contains(" samples early"));
    CHECK(found->help.at(0).options.at(0).option == "align");
    const ReplayResult aligned = replay(bench.read(scene_of(4, methods + "align: {terms: [delay], learn: run}\n")));
    CHECK(aligned.warnings.find("sensors_out_of_time") == nullptr);
    CHECK(named(aligned, "mean").rmse < 0.8 * named(result, "mean").rmse);
  }
  for (const double late : {0., 1.}) {  // none, and all of them alike, which nobody sees
    bench.put("array.csv", log({late, late, late}, 0.1));
    const ReplayResult result = replay(bench.read(scene_of(3, "algorithms: [mean]\n")));
    CHECK(result.warnings.find("sensors_out_of_time") == nullptr);
  }
}

TEST_CASE("verdict: five of twelve sensors that break are all named") {
  std::vector<Sensor> sensors(12, Sensor{0.1});
  for (const std::size_t i : {1U, 4U, 5U, 8U, 10U}) sensors[i].jump = 2 + static_cast<double>(i);
  const test::SceneBench bench;
  bench.put("array.csv", array_log(sensors, 20000, 6));
  const ReplayResult result = replay(bench.read(scene_of(12, "algorithms: [mean, minque]\n")));
  CHECK_THAT(test::verdict_of(result, false), Contains("s2, s5, s6, s9, s11"));
  REQUIRE(result.best);
  CHECK(result.algorithms[*result.best].label == "minque");
}

TEST_CASE("verdict: the middle one of three sensors, whose scatter about their median is nothing, does not fail") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const test::SceneBench bench;
    bench.put("array.csv", array_log({{0.05, 0.3, 1.03}, {0.06, -0.1}, {0.05, 0.2, 0.97}}, 20000, seed));
    for (const char* reference : {"", "reference: truth\nlearning: [0, 100]\nevaluation: [100, end]\n"}) {
      INFO(seed << " " << reference);
      const ReplayResult result =
          replay(bench.read(scene_of(3, std::string("algorithms: [mean, median]\n") + reference)));
      CHECK(result.warnings.find("sensor_failing") == nullptr);
      CHECK(result.warnings.find("sensor_apart") == nullptr);
    }
  }
}

TEST_CASE("verdict: a sensor in another unit is named where the alignment takes its gain out") {
  const test::SceneBench bench;
  bench.put("array.csv", array_log({{0.1}, {0.1}, {5.7, 0, 57}, {0.1}}, 8000, 3));
  const ReplayResult result = replay(bench.read(scene_of(4, "reference: truth\n")));
  REQUIRE(result.alignment);
  CHECK_THAT(test::verdict_of(result, false), Contains("s3: gain 57"));
}

TEST_CASE("verdict: of three sensors the method that withstands a failing one is chosen, and the one is named") {
  // Leave-one-out leaves two sensors, too few for the methods that watch each other.
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const test::SceneBench bench;
    bench.put("array.csv", array_log({{0.5}, {1, 0, 1, 25}, {1}}, 12000, seed));
    const ReplayResult result =
        replay(bench.read(scene_of(3, "algorithms: [mean, median, minque, blind-calibration]\n")));
    REQUIRE(result.best);
    CHECK(result.chosen_as_robust);
    CHECK(result.algorithms[*result.best].label == "minque");
    const Finding* failing = result.warnings.find("sensor_failing");
    REQUIRE(failing != nullptr);
    CHECK(failing->count == 1);
    CHECK_THAT(test::verdict_of(result, false),
               StartsWith("Use minque: a failing or deviating sensor") && Contains("s2: up to 2"));
  }
}

TEST_CASE("verdict: of four sensors as well, as their scores are those of three with the failing one among them") {
  const test::SceneBench bench;
  const std::string scene = scene_of(4, "algorithms: [median, random-weighting, minque]\n");
  bench.put("array.csv", array_log({{1}, {1, 0, 1, 25}, {1}, {1}}, 12000, 2));
  const ReplayResult fails = replay(bench.read(scene));
  REQUIRE(fails.best);
  CHECK(fails.chosen_as_robust);
  CHECK(fails.algorithms[*fails.best].label == "minque");
  CHECK_THAT(test::verdict_of(fails, false), Contains("scores arrays of three sensors, and one of the four fails"));
  bench.put("array.csv", array_log({{1}, {1}, {1}, {1}}, 12000, 2));
  CHECK_FALSE(replay(bench.read(scene)).chosen_as_robust);
}

TEST_CASE("verdict: sound sensors with offsets, gains and noise of their own are none that fail or stand apart") {
  std::size_t said = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const test::SceneBench bench;
    bench.put("array.csv", array_log({{1, 1}, {0.7, -2}, {1.5, 0.5}, {1, 3}, {1.2, -1}}, 8000, seed));
    const ReplayResult result = replay(bench.read(scene_of(5, "algorithms: [mean, median]\n")));
    said += result.warnings.find("sensor_failing") != nullptr ? 1 : 0;
    said += result.warnings.find("sensor_apart") != nullptr ? 1 : 0;
  }
  CHECK(said == 0);
}

TEST_CASE("verdict: outliers of all sensors name none of them, and do not hide the one that fails") {
  for (const double share : {1e-4, 1e-3, 1e-2})
    for (const std::size_t n : {3U, 4U, 6U})
      for (const double jump : {0., 25.}) {
        INFO(share << " of " << n << " sensors, jump " << jump);
        std::vector<Sensor> sensors(n, Sensor{1, 0, 1, 0, share});
        sensors[1].jump = jump;
        const test::SceneBench bench;
        bench.put("array.csv", array_log(sensors, 20000, n));
        const ReplayResult result = replay(bench.read(scene_of(n, "algorithms: [mean, median, minque]\n")));
        if (jump == 0) CHECK(result.warnings.find("fault_watch_stood_down") == nullptr);
        const Finding* failing = result.warnings.find("sensor_failing");
        REQUIRE((failing != nullptr) == (jump > 0));
        if (jump > 0) CHECK_THAT(failing->where.rows.at(0), StartsWith("s2"));
        if (jump > 0) CHECK(failing->count == 1);
      }
}

TEST_CASE("verdict: a sensor with a few outliers does not fail for a part of the run") {
  // Blocks of 256 samples with one have much scatter, and those between them little: neither lasts.
  std::size_t said = 0;
  for (const double share : {1e-3, 2e-3, 3e-3, 5e-3})
    for (const std::size_t n : {3U, 4U, 6U})
      for (const std::uint64_t seed : {1U, 2U, 3U}) {
        std::vector<Sensor> sensors(n, Sensor{1});
        sensors[1].outliers = share;
        const test::SceneBench bench;
        bench.put("array.csv", array_log(sensors, 20000, 100 * seed + n));
        const ReplayResult result = replay(bench.read(scene_of(n, "algorithms: [mean, median]\n")));
        said += result.warnings.find("sensor_failing") != nullptr ? 1 : 0;
      }
  CHECK(said == 0);
}

TEST_CASE("verdict: one per cent is no difference") {
  const test::SceneBench bench;
  bench.put("array.csv", array_log({{1}, {1.02}, {0.98}, {1}}, 60000, 4));
  const ReplayResult result = replay(bench.read(scene_of(4, "reference: truth\nalgorithms: [mean, minque]\n")));
  CHECK(named(result, "mean").as_good_as_best);
  CHECK(named(result, "minque").as_good_as_best);
  CHECK_THAT(test::verdict_of(result, false), Contains("Within 1 % of it: "));
}

TEST_CASE("verdict: a record of a few instants tells no method from another") {
  const test::SceneBench bench;
  for (const int rows : {2, 3, 7}) {
    std::string text = "t[s],a[V],b[V],c[V]\n";
    for (int k = 0; k < rows; ++k)
      text += std::to_string(k) + "," + std::to_string(k % 2) + "," + std::to_string(k % 3) + ",0." +
              std::to_string(7 * k % 5) + "\n";
    bench.put("few.csv", text);
    const ReplayResult result =
        replay(bench.read("format: scene\nversion: 1\nrecording: few.csv\nsensors: [a, b, c]\n"));
    REQUIRE(result.best);
    for (const AlgorithmResult& a : result.algorithms)
      if (a.ran && std::isfinite(a.rmse)) CHECK(a.as_good_as_best);
    CHECK(test::verdict_of(result).find("long enough to show it") == std::string::npos);
  }
}
