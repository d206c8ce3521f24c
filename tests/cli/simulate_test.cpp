#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;
namespace fs = std::filesystem;

namespace {

struct SimulateBench {
  test::TemporaryFolder folder;
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  std::string gyro() const {
    return file("gyro.sensor.yaml",
                "format: sensor-model\nversion: 1\nchannel: gyr_x\nunit: deg/s\nrate_hz: 100\ndensity: "
                "two-sided\nwhite_noise: 0.01\nbias: {value: 0.5, spread: 0.1}\n");
  }
};

}  // namespace

TEST_CASE("simulate: every log format holds the same samples, and truth stands beside them") {
  const SimulateBench bench;
  const std::string model = bench.gyro();
  std::vector<double> first;
  for (const std::string name : {"a.csv", "a.npy", "a.f64"}) {
    const auto ran = test::run({"simulate", model, "-o", bench.path(name), "--samples", "500", "--truth",
                                "sine,amplitude=2,frequency_hz=0.5", "--force"});
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK_THAT(ran.out, Contains("500 samples of 2 channels at 100 Hz, 5 s, seed 1"));
    libchar::ReadOptions reading;
    reading.rate_hz = 100;
    const auto log = libchar::read_recording(bench.path(name), reading);
    CHECK(log.samples.size() == 2);
    CHECK(log.info.time.rate_hz == Approx(100));
    if (name != "a.npy") {
      CHECK(log.info.channels[0].name == "gyr_x");
      CHECK(log.info.channels[1].name == "truth");
      CHECK(log.info.channels[0].unit == "deg/s");
    }
    if (first.empty()) first = log.samples[0];
    CHECK(log.samples[0] == first);
    CHECK(log.samples[1][25] == Approx(2 * std::sin(3.14159265358979 * 0.25)));
  }
}

TEST_CASE("simulate: a seed is a recording, devices differ, white noise has its variance") {
  const SimulateBench bench;
  const std::string model = bench.gyro();
  const auto make = [&](const std::string& out, const std::string& seed) {
    const auto ran =
        test::run({"simulate", model, "-o", bench.path(out), "--duration", "200s", "--seed", seed, "--devices", "3"});
    REQUIRE(ran.code == 0);
    return test::slurp(bench.path(out));
  };
  const std::string a = make("a.csv", "1");
  CHECK(make("b.csv", "1") == a);
  CHECK(make("c.csv", "2") != a);
  const auto log = libchar::read_recording(bench.path("a.csv"));
  REQUIRE(log.info.channels.size() == 4);
  CHECK(log.info.channels[2].name == "gyr_x3");
  CHECK(log.samples[0] != log.samples[1]);
  libchar::Moments one;
  one.push(log.samples[0]);
  CHECK(one.standard_deviation() == Approx(0.1).epsilon(0.03));
  CHECK(one.mean() == Approx(0.5).margin(0.5));
}

TEST_CASE("simulate: the scene it writes is read back, and simulates the same again") {
  const SimulateBench bench;
  REQUIRE(test::run({"simulate", bench.gyro(), "-o", bench.path("a.csv"), "--samples", "50", "--devices", "2",
                     "--fault", "gyr_x1:bias=3@0.1..0.2"})
              .code == 0);
  const std::string scene = test::slurp(bench.path("a.scene.yaml"));
  CHECK_THAT(scene, Contains("format: scene"));
  CHECK_THAT(scene, Contains("gyr_x2"));
  CHECK_THAT(scene, Contains("recording: "));
  const auto again = test::run({"simulate", bench.path("a.scene.yaml"), "-o", bench.path("b.csv")});
  CHECK(again.code == 0);
  CHECK(test::slurp(bench.path("b.csv")) == test::slurp(bench.path("a.csv")));
  CHECK_THAT(test::slurp(bench.path("b.scene.yaml")), Contains("recording: \"b.csv\""));
}

TEST_CASE("simulate: a scene file says it all") {
  const SimulateBench bench;
  bench.gyro();
  const std::string scene =
      bench.file("s.scene.yaml",
                 "format: scene\nversion: 1\nname: two\nsimulate:\n  rate_hz: 50\n  samples: 100\n  seed: 4\n"
                 "  truth: {kind: uniform, amplitude: 10}\nsensors:\n  - {name: g, count: 2, model: gyro.sensor.yaml}\n"
                 "faults:\n  - {sensor: g1, kind: dropout, from_s: 1.0, to_s: 1.5}\nlearning: [0, 1]\n");
  const auto ran = test::run({"simulate", scene, "-o", bench.path("a.csv"), "--json"});
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  const libchar::Json document = libchar::parse_json(ran.out, "stdout");
  CHECK(document["format"] == "simulation");
  CHECK(document["seed"] == 4);
  CHECK(document["sensors"].size() == 2);
  REQUIRE(document["input"].size() == 1);
  CHECK(document["input"][0]["path"] == scene);
  CHECK(document["input"][0]["sha256"].get<std::string>().size() == 64);
  CHECK_THAT(test::slurp(bench.path("a.scene.yaml")), Contains("learning: [0.0, 1.0]"));
  CHECK(test::run({"simulate", scene, "-o", bench.path("gyro.sensor.yaml"), "--as", "csv", "--force"}).code == 5);
  const auto log = libchar::read_recording(bench.path("a.csv"));
  CHECK(log.info.samples == 100);
  CHECK(std::isnan(log.samples[0][60]));
  CHECK_FALSE(std::isnan(log.samples[1][60]));
  CHECK_FALSE(std::isnan(log.samples[0][75]));
}

TEST_CASE("simulate: what cannot be is one sentence, and nothing is written") {
  const SimulateBench bench;
  const std::string model = bench.gyro(), out = bench.path("o.csv");
  const struct {
    std::vector<std::string> arguments;
    int code;
    std::string says;
  } cases[] = {
      {{model, "-o", out}, 2, "the length is missing"},
      {{bench.file("n.yaml", "format: sensor-model\nversion: 1\n"), "-o", out, "--samples", "5"},
       2,
       "states no sampling rate"},
      {{model, "-o", out, "--samples", "5", "--fault", "gyr_y:bias=1@0..1"}, 2, "did you mean gyr_x?"},
      {{model, "-o", out, "--samples", "5", "--fault", "gyr_x:bias@0..1"}, 2, "needs a value"},
      {{model, "-o", out, "--samples", "5", "--fault", "gyr_x:bais=1@0..1"}, 2, "expected one of scale, bias"},
      {{model, "-o", out, "--samples", "5", "--fault", "gyr_x:noise=-1@0..1"}, 2, "noise needs a value of at least 0"},
      {{model, "-o", out, "--samples", "5", "--duration", "3"}, 2, "does not go with --duration"},
      {{model, "-o", out, "--samples", "5", "--seed", "-1"}, 2, "--seed: error"},
      {{model, "-o", out, "--samples", "5", "--scene", out}, 5, "two outputs are one file"},
      {{model, "-o", out, "--samples", "5", "--truth", "recording,file=absent.csv"}, 3, "absent.csv"},
      {{bench.file("fast.yaml", "format: sensor-model\nversion: 1\nrate_hz: 1e300\n"), "-o", out, "--samples", "5"},
       2,
       "not between 1 nHz and 1 GHz"},
      {{model, "-o", out, "--samples", "5", "--truth", "sinus"}, 3, "did you mean sine?"},
      {{model, "-o", out, "--samples", "5", "--truth", "constant"}, 3, "value is missing"},
      {{model, "-o", out, "--samples", "5", "--truth", "ramp"}, 3, "slope is missing"},
      {{model, "-o", out, "--samples", "5", "--truth", "sine,amplitud=1"}, 3, "did you mean amplitude?"},
      {{model, model, "-o", out, "--samples", "5", "--rate", "0"}, 2, "--rate"},
      {{model, "-o", model, "--samples", "5", "--as", "csv", "--force"}, 5, "is the input itself"},
      {{bench.path("absent.yaml"), "-o", out, "--samples", "5"}, 3, "cannot be read"},
      {{bench.file("b.yaml", "format: sensor-model\nversion: 1\nwhite_niose: 1\n"), "-o", out, "--samples", "5"},
       3,
       "b.yaml:3:1"},
  };
  for (const auto& one : cases) {
    std::vector<std::string> words = {"simulate"};
    words.insert(words.end(), one.arguments.begin(), one.arguments.end());
    const auto ran = test::run(words);
    INFO(ran.err);
    CHECK(ran.code == one.code);
    CHECK_THAT(ran.err, Contains(one.says));
    CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
    CHECK_FALSE(fs::exists(out));
    CHECK_FALSE(fs::exists(bench.path("o.scene.yaml")));
  }
  REQUIRE(test::run({"simulate", model, "-o", out, "--samples", "5"}).code == 0);
  CHECK(test::run({"simulate", model, "-o", out, "--samples", "5"}).code == 5);
}

TEST_CASE("simulate: truth from a log, a bare number, and a fault after the end") {
  const SimulateBench bench;
  const std::string model =
      bench.file("ideal.yaml", "format: sensor-model\nversion: 1\nchannel: a\nunit: deg/s\nrate_hz: 100\n");
  const std::string log = bench.file("log.csv", "t[s],x[deg/s],y[deg/s]\n0,1,5\n0.01,2,6\n0.02,4,7\n");
  const std::string out = bench.path("o.csv");
  const std::string truth = "recording,file=" + log;
  const auto simulate = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"simulate", model, "-o", out, "--force", "--samples", "4"};
    words.insert(words.end(), more.begin(), more.end());
    return test::run(words);
  };
  auto ran = simulate({"--truth", truth + ",channel=x"});
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.err, Contains("its last sample is held"));
  CHECK(libchar::read_recording(out, {}).samples[0] == std::vector<double>{1, 2, 4, 4});
  ran = simulate({"--truth", truth});
  CHECK(ran.code == 2);
  CHECK_THAT(ran.err, Contains("channel=NAME"));
  ran = simulate({"--rate", "50", "--truth", truth + ",channel=x"});
  CHECK(ran.code == 2);
  CHECK_THAT(ran.err, Contains("--rate 100"));
  REQUIRE(simulate({"--truth", "3"}).code == 0);
  CHECK(libchar::read_recording(out, {}).samples[1] == std::vector<double>(4, 3.0));
  ran = simulate({"--fault", "a:bias=1@10..20"});
  CHECK(ran.code == 0);
  CHECK_THAT(ran.err, Contains("after the end of the recording"));
}

TEST_CASE("simulate: a characterized model closes the loop on the command line") {
  const SimulateBench bench;
  REQUIRE(
      test::run({"characterize", test::fixture("imu_at_rest.csv").string(), "-o", bench.path("d"), "--verify", "-q"})
          .code == 0);
  REQUIRE(test::run(
              {"simulate", bench.path("d/gyro_z.sensor.yaml"), "-o", bench.path("s.npy"), "--duration", "1000s", "-q"})
              .code == 0);
  const auto ran = test::run({"fit", bench.path("s.npy"), "--rate", "50", "--json", "-c", "c0"});
  REQUIRE(ran.code == 0);
  const libchar::Json fit = libchar::parse_json(ran.out, "stdout");
  CHECK(fit["channels"][0]["white_noise"]["value"].get<double>() == Approx(4e-3).epsilon(0.02));
}
