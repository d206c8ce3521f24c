// One rule of units for logs and scenes: one quantity in several units is converted, two quantities are refused.
#include "libchar/replay/detail/plan/common_unit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/units.hpp"
#include "libchar/replay/fuse.hpp"
#include "libchar/replay/replay.hpp"
#include "tests/replay/kept_columns.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

struct UnitCase {
  const char *first, *others;
  double factor;  // from the others' numbers to the first's
};

std::string log_in(const UnitCase& units, double first) {
  std::string text =
      fmt::format("t[s],a[{}],b[{}],c[{}],x[{}]\n", units.first, units.others, units.others, units.others);
  test::Gaussian gauss(5);
  for (int k = 0; k < 3000; ++k) {
    const double x = 3 * std::sin(0.03 * k);
    text +=
        fmt::format("{},{},{},{},{}\n", 0.01 * k, first * (x + 0.1 * gauss()), x + 0.1 * gauss(), x + 0.2 * gauss(), x);
  }
  return text;
}

constexpr const char* kUnitScene =
    "format: scene\nversion: 1\nrecording: log.csv\nsensors: [{name: a, noise: 0.1}, b, c]\nreference: {channels: "
    "[x]}\nevaluation: [0, end]\n";

std::string unit_refusal(const test::SceneBench& bench, const char* scene = kUnitScene) {
  try {
    replay(bench.read(scene));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("units of samples: a factor between units of one quantity, nothing where none does it") {
  CHECK(*Unit::sample_factor("deg/s", "rad/s") == Approx(std::acos(-1.0) / 180));
  CHECK(*Unit::sample_factor("dps", "deg/s") == 1);
  CHECK(*Unit::sample_factor("", "deg/s") == 1);
  CHECK(*Unit::sample_factor("ppm", "ppb") == Approx(1000));
  CHECK_FALSE(Unit::sample_factor("V", "deg/s"));
  CHECK_FALSE(Unit::sample_factor("counts", "deg/s"));
  CHECK_FALSE(Unit::sample_factor("degC", "K"));
  CHECK_FALSE(Unit::sample_factor("degC", "degF"));
  CHECK_FALSE(Unit::sample_factor("ppm", "ug/m3"));
  CHECK(*Unit::sample_factor("0.01 degC", "degC") == Approx(0.01));
}

TEST_CASE("units of a scene: sensors of one quantity are converted to the reference's unit") {
  test::SceneBench bench;
  bench.put("log.csv", log_in({"deg/s", "deg/s", 1}, 1));
  const ReplayResult alike = replay(bench.read(kUnitScene));
  for (const UnitCase& units : {UnitCase{"rad/s", "deg/s", std::acos(-1.0) / 180}, UnitCase{"g", "m/s^2", 1 / 9.80665},
                                UnitCase{"Pa", "hPa", 100}}) {
    bench.put("log.csv", log_in(units, units.factor));
    const ReplayResult result = replay(bench.read(kUnitScene));
    CHECK(test::named(result, "mean").rmse == Approx(test::named(alike, "mean").rmse).epsilon(1e-4));
    CHECK(result.sensors[0].unit == units.others);
    CHECK_THAT(fmt::format("{}", fmt::join(result.plan, "\n")),
               Contains(fmt::format("converts to {}: a from {}", units.others, units.first)));
    // The level of the scene is in the sensor's own unit.
    CHECK(*result.sensors[0].noise_variance == Approx(std::pow(0.1 / units.factor, 2)));
    KeptColumns fused;
    FuseOptions options;
    options.algorithm = "mean";
    fuse(bench.path("log.csv"), parse_fusion_file(fusion_yaml(result.learnt), "fusion.yaml"), fused, options);
    double squares = 0;
    for (int k = 0; k < 3000; ++k)
      squares += std::pow(fused.columns[0][static_cast<std::size_t>(k)] - 3 * std::sin(0.03 * k), 2);
    CHECK(std::sqrt(squares / 3000) == Approx(test::named(alike, "mean").rmse).epsilon(1e-3));
  }
}

TEST_CASE("units of a scene: two quantities are refused in a sentence, weights of a scene convert themselves") {
  test::SceneBench bench;
  bench.put("log.csv", log_in({"V", "deg/s", 1}, 1));
  CHECK_THAT(unit_refusal(bench), Contains("E0918") && Contains("a is in V, and x in deg/s"));
  bench.put("log.csv", log_in({"degC", "K", 1}, 1));
  CHECK_THAT(unit_refusal(bench), Contains("E0918"));
  const ReplayResult own =
      replay(bench.read("format: scene\nversion: 1\nrecording: log.csv\nsensors: [{name: a, scale: 2, unit: K}, b, "
                        "c]\nreference: {channels: [x]}\n"));
  CHECK(own.sensors[0].unit == "K");
  bench.put("log.csv", log_in({"rad/s", "deg/s", 1}, 1));
  const ReplayResult weighed =
      replay(bench.read("format: scene\nversion: 1\nrecording: log.csv\nsensors: [{name: a, h: [0.5]}, b, "
                        "c]\nreference: {channels: [x]}\n"));
  CHECK(weighed.sensors[0].unit == "rad/s");
}

TEST_CASE("units of a tilt: both axes of gravity are in one unit, and only a rate turns") {
  test::SceneBench bench;
  const char* const scene =
      "format: scene\nversion: 1\nrecording: log.csv\nsensors: [w, x, z]\n"
      "tilt: {gyroscope: w, accelerometer_x: x, accelerometer_z: z}\nreference: {channels: [tilt]}\n";
  const auto log = [](const char* rate, const char* x, double factor) {
    std::string text = fmt::format("t[s],w[{}],x[{}],z[m/s^2],tilt[rad]\n", rate, x);
    for (int k = 0; k < 2000; ++k) {
      const double angle = 0.5 * std::sin(0.02 * k);
      text += fmt::format("{},{},{},{},{}\n", 0.01 * k, 0.5 * 2 * std::cos(0.02 * k),
                          std::sin(angle) * 9.80665 / factor, std::cos(angle) * 9.80665, angle);
    }
    return text;
  };
  for (const auto& [unit, factor] : {std::pair("m/s^2", 1.0), std::pair("g", 9.80665)}) {
    bench.put("log.csv", log("rad/s", unit, factor));
    const ReplayResult result = replay(bench.read(scene));
    CHECK(test::named(result, "tilt-accelerometer").rmse < 1e-4);
  }
  bench.put("log.csv", log("V", "g", 1));
  CHECK_THAT(unit_refusal(bench, scene), Contains("E0918") && Contains("w is in V"));
}
