#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;
namespace fs = std::filesystem;

namespace {

// Three sensors of a sine, learnt for 10 s of 60 at 100 Hz; the log of another seed.
constexpr const char* kFusedScene = R"(format: scene
version: 1
name: three
simulate:
  rate_hz: 100
  samples: 6000
  truth: {name: level, kind: sine, amplitude: 2, frequency_hz: 0.1}
sensors:
  - {name: a, model: {unit: m, white_noise: {value: 0.01}, density: two-sided}}
  - {name: b, model: {unit: m, white_noise: {value: 0.02}, density: two-sided}}
  - {name: c, model: {unit: m, white_noise: {value: 0.03}, density: two-sided}}
learning: [0, 10]
)";

struct FuseProgram {
  FuseProgram() {
    std::ofstream(path("scene.yaml")) << kFusedScene;
    REQUIRE(test::run({"replay", path("scene.yaml"), "-o", path("run"), "--algorithms", "mean,least-squares,minque",
                       "--estimates", "csv"})
                .code == 0);
    REQUIRE(test::run({"simulate", path("scene.yaml"), "-o", path("log.csv")}).code == 0);
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  /// fuse LOG --with RUN -o OUT and more; files of the folder.
  test::Ran fuse(const std::string& log, const std::string& with, const std::string& out,
                 const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"fuse", path(log), "--with", path(with), "-o", path(out)};
    words.insert(words.end(), more.begin(), more.end());
    return test::run(words);
  }
  test::TemporaryFolder folder;
};

}  // namespace

TEST_CASE("fuse: a run applied to a log, as csv and npy, whole or not at all") {
  const FuseProgram bench;
  const auto ran = bench.fuse("log.csv", "run", "fused.csv");
  INFO(ran.out + ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("6000 instants at 100 Hz fused by") && Contains("100 % with an estimate"));
  CHECK_THAT(ran.out, Contains("wrote " + bench.path("fused.csv")));
  const auto piped = test::run({"fuse", bench.path("log.csv"), "--with", bench.path("run"), "-o", "-"});
  CHECK(piped.code == 0);
  CHECK(piped.out == test::slurp(bench.path("fused.csv")));
  const libchar::Recording fused = libchar::read_recording(bench.path("fused.csv"));
  REQUIRE(fused.info.channels.size() == 5);
  CHECK(fused.info.channels[0].name == "level");
  CHECK(fused.info.channels[0].unit == "m");
  CHECK(fused.info.channels[1].name == "level sd");
  CHECK(fused.info.channels[4].name == "c used");
  CHECK(fused.info.samples == 6000);
  CHECK(fused.info.time.rate_hz == Approx(100));
  // The replay's own estimates: its evaluation begins at 10 s.
  const auto same = bench.fuse("log.csv", "run/fusion.yaml", "same.npy", {"--algorithm", "least-squares"});
  REQUIRE(same.code == 0);
  const libchar::Recording npy = libchar::read_recording(bench.path("same.npy"));
  const libchar::Recording replayed = libchar::read_recording(bench.path("run/estimates.csv"));
  std::size_t column = 0;
  while (replayed.info.channels[column].name != "least-squares") ++column;
  REQUIRE(replayed.samples[column].size() == 5000);
  for (std::size_t k = 0; k < 5000; ++k) REQUIRE(npy.samples[0][1000 + k] == replayed.samples[column][k]);
  // Nothing is overwritten, and what is refused leaves nothing.
  const auto again = bench.fuse("log.csv", "run", "fused.csv");
  CHECK(again.code == 5);
  CHECK_THAT(again.err, Contains("--force"));
  const auto missing = bench.fuse("log.csv", "run", "none.csv", {"--algorithm", "meen"});
  CHECK(missing.code == 2);
  CHECK_THAT(missing.err, Contains("did you mean mean?"));
  CHECK_FALSE(fs::exists(bench.path("none.csv")));
}

TEST_CASE("fuse: --json, --map and refusals that name flags") {
  const FuseProgram bench;
  std::string text = test::slurp(bench.folder / "log.csv");
  text.replace(text.find("b[m]"), 4, "q[m]");
  std::ofstream(bench.path("other.csv")) << text;
  const auto json = bench.fuse("other.csv", "run", "a.csv", {"--algorithm", "mean", "--json"});
  INFO(json.err);
  REQUIRE(json.code == 0);
  const auto document = libchar::parse_json(json.out, "stdout");
  CHECK(document["format"] == "fuse");
  CHECK(document["algorithm"] == "mean");
  CHECK(document["rows"] == 6000);
  CHECK(document["with"]["sha256"].get<std::string>().size() == 64);
  CHECK(document["sensors"][1]["channel"].is_null());
  CHECK(document["sensors"][1]["missing"] == 1);
  CHECK(document["findings"][0]["code"] == "sensor_not_in_log");
  CHECK_THAT(json.err, Contains("does not have these sensors"));
  const auto mapped = bench.fuse("other.csv", "run", "b.csv", {"--map", "b=q", "--quiet"});
  CHECK(mapped.code == 0);
  CHECK(mapped.err.empty());
  const auto wrong = bench.fuse("other.csv", "run", "c.csv", {"--map", "d=q"});
  CHECK(wrong.code == 2);
  CHECK_THAT(wrong.err, Contains("--map"));
  const auto folder = bench.fuse("other.csv", "", "d.csv");
  CHECK(folder.code == 3);
  CHECK_THAT(folder.err, Contains("no fusion.yaml"));
  const auto own = bench.fuse("other.csv", "run", "other.csv", {"--force"});
  CHECK(own.code == 5);
}
