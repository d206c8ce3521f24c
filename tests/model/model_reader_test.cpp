
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/error.hpp"
#include "libchar/model/detail/noise_term.hpp"
#include "libchar/model/model_file.hpp"
#include "tests/report/synthetic.hpp"
#include "tests/support/places.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

const std::string kHead = "format: sensor-model\nversion: 1\nunit: rad/s\nrate_hz: 200\n";

SensorModel parse(const std::string& body) { return parse_sensor_model(kHead + body, "m.yaml"); }

std::string refusal(const std::string& text, const std::string& file = "m.yaml") {
  try {
    parse_sensor_model(text, file);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

double white_of(const std::string& unit, const std::string& density, double value = 1) {
  return *parse("density: " + density + "\nwhite_noise: {value: " + std::to_string(value) + ", unit: \"" + unit +
                "\"}\n")
              .noise[0]
              .value;
}

}  // namespace

TEST_CASE("model reader: what the writer wrote reads back to the same file") {
  const auto result = test::synthetic_imu();
  for (const ChannelResult& c : result.channels) {
    SensorModel m = sensor_model_from(c, result.log);
    m.scale_factor = {1.02, 0.01, 1e-4, 2e-6};
    m.nonlinearity = {0.01, 0.003, -0.02, -0.001};
    m.bias = {0.05, 0.2, 1e-3, -2e-5};
    m.reference_temperature_degc = 20;
    m.sensitivity = {0.8, "V"};
    m.noise_start = NoiseStart::zero;
    m.flicker_hold_s = 1;
    m.kind = "gyroscope";
    m.axis = "x";
    const std::string text = model_yaml(m);
    CHECK(model_yaml(parse_sensor_model(text, "m.yaml")) == text);
  }
}

TEST_CASE("model reader: an interval without an upper end reads back") {
  SensorModel m = parse("density: two-sided\nwhite_noise: {value: 2, ci95: [1, null], status: detected}\n");
  CHECK(std::isinf(m.noise[0].ci95.high));
  const SensorModel again = parse_sensor_model(model_yaml(m), "m.yaml");
  CHECK(again.noise[0].ci95 == m.noise[0].ci95);
}

TEST_CASE("model reader: units of data sheets become the two-sided density of the channel") {
  const double degree = std::numbers::pi / 180, root2 = std::numbers::sqrt2;
  CHECK(white_of("deg/√h", "one-sided") == Approx(degree / 60).epsilon(1e-14));
  CHECK(white_of("deg/sqrt(hr)", "two-sided") == Approx(degree / 60).epsilon(1e-14));
  CHECK(white_of("deg/s/√Hz", "one-sided") == Approx(degree / root2).epsilon(1e-14));
  CHECK(white_of("mdps/rtHz", "two-sided", 3.5) == Approx(3.5e-3 * degree).epsilon(1e-14));
  CHECK(white_of("(rad/s)/√Hz", "two-sided") == 1);
  CHECK(white_of("rad/s·√s", "one-sided") == 1);  // Q itself: no side to take
  CHECK(white_of("deg/h/√Hz", "two-sided") == Approx(degree / 3600).epsilon(1e-14));
  const SensorModel m = parse(
      "density: one-sided\nbias_instability: {value: 7, unit: deg/h, reading: floor}\nrandom_walk: {value: 2, unit: "
      "deg/h/√h}\nquantization: {value: 3, unit: arcsec}\nrate_ramp: {value: 4, unit: deg/h/h}\n");
  CHECK(*m.noise[1].value == Approx(7 * degree / 3600 / 0.66428247).epsilon(1e-8));
  CHECK(*m.noise[2].value == Approx(2 * degree / 3600 / 60).epsilon(1e-14));
  CHECK(*m.noise[3].value == Approx(3 * std::numbers::pi / 648000).epsilon(1e-14));
  CHECK(*m.noise[4].value == Approx(4 * degree / 3600 / 3600).epsilon(1e-14));
  CHECK(m.remarks.size() == 4);
  CHECK(m.remarks[0].find("divided by 0.6643") != std::string::npos);
  const auto unit = find_noise_unit(Term::white, "µg/√Hz", "m/s^2");
  REQUIRE(unit);
  CHECK(unit->factor == Approx(9.80665e-6).epsilon(1e-14));
  CHECK(find_noise_unit(Term::white, "m/s/√h", "g")->factor == Approx(1 / 60.0 / 9.80665).epsilon(1e-14));
  CHECK(find_noise_unit(Term::walk, "m/s^3/√Hz", "m/s^2")->factor == 1);
  CHECK(find_noise_unit(Term::white, "counts/√Hz", "counts")->factor == 1);
  CHECK(find_noise_unit(Term::white, "U/√Hz", "")->density);
  CHECK(find_noise_unit(Term::white, "mV/√Hz", "V")->factor == Approx(1e-3).epsilon(1e-14));
  CHECK_FALSE(find_noise_unit(Term::white, "deg/h", "rad/s"));
  CHECK_FALSE(find_noise_unit(Term::walk, "deg/√h", "rad/s"));
  CHECK_FALSE(find_noise_unit(Term::white, "µg/√Hz", "rad/s"));
  for (const std::string channel : {"rad/s", "m/s²", "µT", ""})
    for (std::size_t t = 0; t < kTerms; ++t)
      for (const std::string& text : noise_unit_examples(static_cast<Term>(t), channel))
        CHECK(find_noise_unit(static_cast<Term>(t), text, channel));
}

TEST_CASE("model reader: a density without its side is asked for") {
  CHECK(refusal(kHead + "white_noise: 0.005\n").starts_with("m.yaml:5:14: error E0545: white_noise: a density"));
  CHECK(refusal(kHead + "white_noise: {value: 1, unit: \"rad/s/√Hz\"}\n").find("density: one-sided") !=
        std::string::npos);
  CHECK(refusal(kHead + "white_noise: {value: 1, unit: \"deg/√h\"}\n").empty());
}

TEST_CASE("model reader: a term without a value keeps its status") {
  const SensorModel m =
      parse("random_walk: {value: null, unit: \"rad/s/√s\", upper95: 2.0e-05, status: not_detected}\n");
  CHECK(m.noise[2].status == Status::not_detected);
  CHECK_FALSE(m.noise[2].value);
  CHECK(*m.noise[2].upper95 == 2e-5);
  CHECK(m.noise[0].status == Status::not_fitted);
  CHECK(simulated_value(m.noise[2]) == 0);
}

TEST_CASE("model reader: bad files name place, key and what would be right") {
  const auto starts = [](const std::string& body, const std::string& begin) {
    INFO(body);
    CHECK(refusal(kHead + body).starts_with("m.yaml:" + begin));
  };
  starts("white_niose: 1\n", "5:1: error E0540: unknown key; got \"white_niose\"; hint: did you mean white_noise?");
  starts("density: two-sided\nwhite_noise: -1e-3\n", "6:14: error E0543");
  starts("density: two-sided\nwhite_noise: .inf\n", "6:14: error E0541");
  starts("density: two-sided\nwhite_noise: 1,5\n", "6:14: error E0541");
  starts("bandwidth_hz: 0\n", "5:15: error E0543");
  starts("saturation: [1, -1]\n", "5:13: error E0543");
  starts("noise_sampling: band-limited\n", "5:17: error E0545");
  starts("white_noise: {value: 1, unit: deg/h}\n", "5:31: error E0545");
  starts("white_noise: {value: 1, unit: \"rad/s·√s\", status: detectd}\n", "5:54: error E0544");
  starts("white_noise: {status: detected}\n", "5:14: error E0545");
  starts("scale_factor: {value: 1, sprad: 0.1}\n", "5:26: error E0540: unknown key in scale_factor");
  starts("bias: 3\n", "5:7: error E0541");
  starts("noise_shape: {kind: boxcar}\n", "5:21: error E0545");
  starts("noise_shape: {kind: measured, frequency_hz: [1, 2], ratio: [1]}\n", "5:");
  starts("noise_shape: {kind: measured, frequency_hz: [2, 1], ratio: [1, 1]}\n", "5:");
  starts("noise_shape: {kind: measured, frequency_hz: [1, 2], ratio: [1, -1]}\n", "5:");
  starts("gauss_markov: {sigma: 1}\n", "5:23: error E0545");
  starts("gauss_markov: {sigma: -1, tau_s: 3}\n", "5:");
  starts("gauss_markov: {sigma: 1, tau_s: 3, sigma_ci95: [1]}\n", "5:");
  starts("gauss_markov: {sigma: 1, tau_s: 3, tau_ci95_s: [1, 2, 3]}\n", "5:");
  starts("noise_shape: {kind: triangle, taps: 3}\n", "5:21: error E0544");
  // A key that the kind does not use would be believed to say something.
  starts("noise_shape: {kind: boxcar, taps: 4, ratio: [1]}\n", "5:45: error E0545");
  starts("noise_shape: {kind: none, taps: 4}\n", "5:33: error E0545");
  starts("noise_shape: {kind: measured, taps: 4, frequency_hz: [1], ratio: [1]}\n", "5:37: error E0545");
  starts("deterministic: [{kind: step, size: 1}]\n", "5:24: error E0545");
  starts("deterministic: [{kind: ramp, size: 1, per_s: 1, at_s: 3}]\n", "5:");
  starts("deterministic: [{kind: warm-up, size: 1, tau_s: 0}]\n", "5:");
  starts("deterministic: [{size: 1, at_s: 3}]\n", "5:");
  starts("deterministic: [{kind: stp, size: 1, at_s: 3}]\n", "5:24: error E0544");
  starts("findings: [{code: motion, severity: dire}]\n", "5:");
  CHECK(refusal("format: sensor-model\nversion: 1\nunit: m/s^2\nwhite_noise: {value: 1e308, unit: \"g·√s\"}\n")
            .starts_with("m.yaml:4:14: error E0545: white_noise: is out of range"));
  CHECK(refusal("format: sensor-model\nversion: 2\n").starts_with("m.yaml:2:10: error E0546"));
  CHECK(refusal("version: 1\n").starts_with("m.yaml:1:1: error E0546"));
  CHECK(refusal(R"({"format":"sensor-model","version":1,"unit":"rad/s","white_noise":null})", "m.json").empty());
  CHECK(refusal(R"({"format":"sensor-model","version":1.0})", "m.json").starts_with("m.json:1:36: error E0546"));
  CHECK(refusal(R"({"format":"sensor-model","version":1,"bandwidth_hz":"x"})", "m.json").find("bandwidth_hz") !=
        std::string::npos);
}

TEST_CASE("model reader: a file that does not say where it is from was written by hand") {
  CHECK(parse("white_noise: 1e-4\ndensity: two-sided\n").obtained == "written by hand");
}

TEST_CASE("model reader: kind and axis from unit and name") {
  SensorModel m;
  const auto axis = [&](const char* name) {
    m.channel = name;
    return axis_of(m);
  };
  CHECK(axis("gyr_x") == "x");
  CHECK(axis("ax") == "x");
  CHECK(axis("Gyro Y [deg/s]") == "y");
  CHECK(axis("accelZ") == "z");
  CHECK(axis("imu0.wz") == "z");
  CHECK(axis("x") == "x");
  CHECK(axis("flux") == "");
  CHECK(axis("index") == "");
  CHECK(axis("temp") == "");
  m.axis = "y";
  CHECK(axis("temp") == "y");
  CHECK(axis("gyr_x") == "y");  // what the file says
  const auto kind = [&](const char* unit) {
    m.unit = unit;
    return kind_of(m);
  };
  CHECK(kind("mg") == "accelerometer");
  CHECK(kind("deg/s") == "gyroscope");
  CHECK(kind("uT") == "magnetometer");
  CHECK(kind("hPa") == "barometer");
  CHECK(kind("degC") == "thermometer");
  CHECK(kind("V") == "sensor");
  CHECK(kind("furlong") == "sensor");
  CHECK(kind("") == "sensor");
  m.kind = "scale";
  CHECK(kind("mg") == "scale");
}

TEST_CASE("model reader: every example of docs/models.md is read") {
  const std::string page = test::slurp(test::source_folder().string() + "/docs/models.md");
  std::size_t examples = 0;
  for (std::size_t at = 0; (at = page.find("```yaml\n", at)) != std::string::npos;) {
    const std::size_t begin = at + 8, end = page.find("```", begin);
    const SensorModel m = parse_sensor_model(page.substr(begin, end - begin), "example");
    CHECK(m.noise[0].value);
    ++examples;
    at = end + 3;
  }
  CHECK(examples == 2);
  // 5.5 mdps/√Hz one-sided, 7 deg/h read off the floor
  const std::size_t begin = page.find("```yaml\n") + 8;
  const SensorModel sheet = parse_sensor_model(page.substr(begin, page.find("```", begin) - begin), "sheet");
  CHECK(*sheet.noise[0].value == Approx(5.5e-3 * std::numbers::pi / 180 / std::numbers::sqrt2));
  CHECK(*sheet.noise[1].value == Approx(7.0 / 3600 * std::numbers::pi / 180 / 0.6642824703));
}
