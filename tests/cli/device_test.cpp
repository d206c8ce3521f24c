// model --to c: the method of a replay as one C99 file, compiled as an engineer would, against fuse on the same log.
#include <fmt/format.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/log/read.hpp"
#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;
namespace fs = std::filesystem;

namespace {

// Four sensors with drift; the log of another seed has a sensor that fails and one with a gap.
constexpr const char* kScene = R"(format: scene
version: 1
name: four
simulate:
  rate_hz: 100
  samples: 12000
  seed: SEED
  truth: {name: level, kind: sine, amplitude: 2, frequency_hz: 0.1}
sensors:
  - {name: a, model: {unit: m, white_noise: 0.001, random_walk: 0.002, density: two-sided}}
  - {name: b, model: {unit: m, white_noise: 0.002, random_walk: 0.001, density: two-sided}}
  - {name: c, model: {unit: m, white_noise: 0.003, random_walk: 0.002, density: two-sided}}
  - {name: d, model: {unit: m, white_noise: 0.002, random_walk: 0.002, density: two-sided}}
learning: [0, 30]
FAULTS)";
constexpr const char* kFaults =
    "faults:\n  - {sensor: b, kind: bias, value: 3, from_s: 60, to_s: 80}\n"
    "  - {sensor: c, kind: dropout, from_s: 90, to_s: 95}\n";

constexpr const char* kMain = R"(
#include "fusion.c"
#include <stdio.h>
int main(void) {
  static fusion_state state;
  double row[N], out[2];
  fusion_real y[N], x = 0, sd = 0;
  int i;
  fusion_init(&state);
  fprintf(stderr, "%u", (unsigned)sizeof state);
  while (fread(row, sizeof(double), N, stdin) == N) {
    for (i = 0; i < N; ++i) y[i] = (fusion_real)row[i];
    out[0] = out[1] = (double)NAN;
    if (fusion_step(&state, y, &x, &sd)) {
      out[0] = (double)x;
      out[1] = sd >= 0 ? (double)sd : (double)NAN;
    }
    fwrite(out, sizeof(double), 2, stdout);
  }
  return 0;
}
)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

class Device {
 public:
  Device() {
    const std::string scene = replaced(kScene, "SEED", "1");
    std::ofstream(path("scene.yaml")) << replaced(scene, "FAULTS", "");
    std::ofstream(path("log.yaml")) << replaced(replaced(kScene, "SEED", "2"), "FAULTS", kFaults);
    std::ofstream(path("main.c")) << kMain;
    run({"replay", path("scene.yaml"), "-o", path("run"), "--no-allan", "--algorithms",
         "mean,inverse-variance,minque,virtual-sensor,least-squares,shrunk-least-squares,non-negative-least-squares,"
         "perceptron,median,neural-simplex",
         "--set", "minque.fault_detection=2"});
    run({"simulate", path("log.yaml"), "-o", path("log.csv")});
  }
  static std::string run(const std::vector<std::string>& words) {
    const auto ran = test::run(words);
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    return ran.out;
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }

  struct Estimates {
    std::vector<double> x, sd;
  };
  Estimates by_fuse(const std::string& algorithm) const {
    run({"fuse", path("log.csv"), "--with", path("run"), "--algorithm", algorithm, "-o", path("fused.npy"), "--force",
         "--quiet"});
    const libchar::Recording fused = libchar::read_recording(path("fused.npy"));
    return {fused.samples[0], fused.samples[1]};
  }
  /// By the compiled file, on the samples of the log; also checks what it says of its state.
  Estimates by_c(const std::string& algorithm, const std::string& dtype) const {
    const auto made = nlohmann::json::parse(run({"model", path("run"), "--to", "c", "--algorithm", algorithm, "--dtype",
                                                 dtype, "-o", path("fusion.c"), "--force", "--json"}));
    const std::string compile =
        fmt::format("gcc -std=c99 -Wall -Wextra -Werror -pedantic -O2 -o {0}/device {0}/main.c -lm 2> {0}/said",
                    folder.path().string());
    const int code = std::system(compile.c_str());
    INFO(test::slurp(path("said")));
    REQUIRE(code == 0);
    const libchar::Recording log = libchar::read_recording(path("log.csv"));
    const std::size_t n = sensors.size();
    std::vector<double> rows(n * log.samples[0].size()), out(2 * log.samples[0].size());
    for (std::size_t i = 0; i < n; ++i) {
      std::size_t column = 0;
      while (log.info.channels[column].name != sensors[i]) ++column;
      for (std::size_t k = 0; k < log.samples[column].size(); ++k) rows[k * n + i] = log.samples[column][k];
    }
    std::ofstream(path("rows"), std::ios::binary)
        .write(reinterpret_cast<const char*>(rows.data()), std::ssize(rows) * 8);
    REQUIRE(std::system(fmt::format("{0}/device < {0}/rows > {0}/out 2> {0}/bytes", folder.path().string()).c_str()) ==
            0);
    CHECK(std::stoul(test::slurp(path("bytes"))) == made["state_bytes"]);
    CHECK_THAT(made["text"].get<std::string>(),
               Contains(fmt::format("State: {} bytes", made["state_bytes"].get<int>())));
    CHECK(made["estimated_cycles"]["cortex-m4f"] > made["operations"]);
    const std::string bytes = test::slurp(path("out"));
    REQUIRE(bytes.size() == 8 * out.size());
    std::memcpy(out.data(), bytes.data(), bytes.size());
    Estimates result;
    for (std::size_t k = 0; 2 * k < out.size(); ++k) {
      result.x.push_back(out[2 * k]);
      result.sd.push_back(out[2 * k + 1]);
    }
    return result;
  }

  test::TemporaryFolder folder;
  std::vector<std::string> sensors = {"a", "b", "c", "d"};
};

/// Largest difference, from the instant `from` on; infinite where one has an estimate and the other has none.
double apart(const std::vector<double>& a, const std::vector<double>& b, std::size_t from = 0) {
  REQUIRE(a.size() == b.size());
  double out = 0;
  for (std::size_t k = from; k < a.size(); ++k) {
    if (std::isnan(a[k]) && std::isnan(b[k])) continue;
    out = std::max(out, std::isnan(a[k]) || std::isnan(b[k]) ? 1e300 : std::abs(a[k] - b[k]));
  }
  return out;
}

/// What `fuse` adds while a sensor reads otherwise than it was learnt to is not in the C text. In the first 40 s none
/// does; later the sensors walk away from what was learnt, and one fails. `from`: instant of the first value.
void check_deviations(const std::vector<double>& fused, const std::vector<double>& c, double tolerance,
                      std::size_t from = 0) {
  constexpr std::size_t kAsLearnt = 4000;
  REQUIRE(fused.size() == c.size());
  std::size_t other = 0, less = 0;
  for (std::size_t k = 0; k < c.size(); ++k) {
    CHECK(std::isnan(fused[k]) == std::isnan(c[k]));
    if (std::isnan(c[k])) continue;
    other += from + k < kAsLearnt && !(std::abs(fused[k] - c[k]) <= tolerance) ? 1 : 0;
    less += fused[k] < c[k] - tolerance ? 1 : 0;
  }
  CHECK(other == 0);
  CHECK(less == 0);
}

}  // namespace

TEST_CASE("model --to c: double has the bits of fuse, float six digits") {
  const Device device;
  for (const char* algorithm : {"mean", "inverse-variance", "minque", "least-squares", "shrunk-least-squares",
                                "non-negative-least-squares", "perceptron"}) {
    INFO(algorithm);
    const Device::Estimates fused = device.by_fuse(algorithm), c = device.by_c(algorithm, "f64");
    CHECK(apart(fused.x, c.x) == 0);
    check_deviations(fused.sd, c.sd, 1e-12);
    const Device::Estimates single = device.by_c(algorithm, "f32");
    CHECK(apart(fused.x, single.x) < (std::string(algorithm) == "minque" ? 2e-4 : 5e-6));
  }
}

TEST_CASE("model --to c: minque takes out the sensor that fails, at the same instants as the library") {
  const Device device;
  const Device::Estimates c = device.by_c("minque", "f64");
  // Without the rule three units of bias would show in the estimate from 60 s to 80 s.
  const auto truth = [](std::size_t k) {
    return 2 * std::sin(2 * 3.14159265358979 * 0.1 * static_cast<double>(k) / 100);
  };
  for (std::size_t k = 6100; k < 7900; ++k) REQUIRE(std::abs(c.x[k] - truth(k)) < 0.1);
}

TEST_CASE("model --to c: the virtual sensor in its steady state") {
  const Device device;
  const Device::Estimates fused = device.by_fuse("virtual-sensor");
  const Device::Estimates c = device.by_c("virtual-sensor", "f64");
  const Device::Estimates single = device.by_c("virtual-sensor", "f32");
  const double sd = fused.sd[5000];
  // Once the library's gains stand still, before the sensor fails.
  const auto part = [](const std::vector<double>& all) {
    return std::vector<double>(all.begin() + 3000, all.begin() + 5900);
  };
  check_deviations(part(fused.sd), part(c.sd), 0.01 * sd, 3000);
  const std::vector<double> a = part(fused.x), b = part(c.x);
  INFO(apart(a, b) / sd);
  CHECK(apart(a, b) < 0.05 * sd);
  CHECK(apart(c.x, single.x) < 1e-4);
}

TEST_CASE("model --to c: the deviation of a level that no reference gives is in it") {
  const Device device;
  const libchar::Recording log = libchar::read_recording(device.path("log.csv"));
  std::ofstream table(device.path("log.csv"));
  table << "t,a,b,c,d\n";
  const std::array<double, 4> offsets = {0.3, -0.2, 0.5, -0.4};
  for (std::size_t k = 0; k < log.samples[0].size(); ++k) {
    table << fmt::format("{:.2f}", static_cast<double>(k) / 100);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      std::size_t column = 0;
      while (log.info.channels[column].name != device.sensors[i]) ++column;
      const double y = log.samples[column][k];
      table << ',' << (std::isnan(y) ? "" : fmt::format("{}", y + offsets[i]));
    }
    table << '\n';
  }
  table.close();
  Device::run({"replay", device.path("log.csv"), "--sensors", "a,b,c,d", "-o", device.path("run"), "--force",
               "--no-allan", "--algorithms", "minque", "--set", "minque.fault_detection=2"});
  const Device::Estimates fused = device.by_fuse("minque"), c = device.by_c("minque", "f64");
  CHECK(fused.sd[100] > 0.1);
  CHECK(apart(fused.x, c.x) == 0);
  // Learnt from the log itself, from whose middle a sensor that walks is away at its beginning: this adds little.
  check_deviations(fused.sd, c.sd, 1e-3 * c.sd[100]);
}

TEST_CASE("model --to c: the complementary filter") {
  Device device;
  device.sensors = {"gyro", "accel_x", "accel_z"};
  const std::string scene = (test::fixture("scenes") / "rv-2.5-tilt.yaml").string();
  Device::run({"replay", scene, "-o", device.path("run"), "--force", "--no-allan", "--algorithms",
               "tilt-complementary,tilt-gyroscope"});
  Device::run({"simulate", scene, "-o", device.path("log.csv"), "--force"});
  for (const char* algorithm : {"tilt-complementary", "tilt-gyroscope"}) {
    INFO(algorithm);
    const Device::Estimates fused = device.by_fuse(algorithm);
    CHECK(apart(fused.x, device.by_c(algorithm, "f64").x) < 1e-12);
  }
}

TEST_CASE("model --to c: what has no form in C is refused, and those that have one are named") {
  const Device device;
  for (const char* algorithm : {"median", "neural-simplex"}) {
    const auto refused = test::run({"model", device.path("run"), "--to", "c", "--algorithm", algorithm});
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Contains(std::string(algorithm) + " has no form in C") &&
                                Contains("these have one: mean, inverse-variance, minque, virtual-sensor"));
  }
  const auto unknown = test::run({"model", device.path("run"), "--to", "c", "--algorithm", "meen"});
  CHECK_THAT(unknown.err, Contains("did you mean mean?"));
  // The recommended one without --algorithm, on stdout.
  const auto plain = test::run({"model", device.path("run"), "--to", "c", "--algorithm", "mean"});
  CHECK(plain.code == 0);
  CHECK_THAT(plain.out, Contains("int fusion_step(") && !Contains("malloc"));
}
