// Records that cannot be searched for motion or steps are fitted all the same.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/fit/curve/power_laws.hpp"
#include "libchar/simulate/sensor_array.hpp"
#include "tests/characterize/refusal.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/npy.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::vector<double> white(std::size_t count, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  std::vector<double> y(count);
  for (double& v : y) v = 0.01 * gauss();
  return y;
}

Characterization of(const std::vector<double>& samples) {
  Recording recording;
  recording.info.channels.resize(1);
  recording.info.channels[0].name = "x";
  recording.info.time.rate_hz = 100;
  recording.samples = {samples};
  return characterize(recording);
}

}  // namespace

TEST_CASE("a hole of half the record, or a tenth, is no change of the noise") {
  for (const double share : {0.1, 0.5}) {
    std::vector<double> y = white(60000, 3);
    for (std::size_t t = 20000; t < 20000 + static_cast<std::size_t>(share * 60000); ++t)
      y[t] = std::numeric_limits<double>::quiet_NaN();
    const Characterization result = of(y);
    const ChannelResult& channel = result.channels[0];
    CAPTURE(share);
    CHECK(channel.findings.empty());
    REQUIRE(channel.fit);
    CHECK(*(*channel.fit)[Term::white].value == Approx(0.001).epsilon(0.03));
  }
}

TEST_CASE("fifty samples are fitted, though steps cannot be looked for") {
  const Characterization result = of(white(50, 4));
  REQUIRE(result.channels[0].fit);
  CHECK(result.channels[0].fit->events.empty());
}

TEST_CASE("the quality of a clock's frequency is in fractions of it, as its noise is") {
  std::vector<double> y = white(20000, 6);
  for (double& v : y) v = 1e7 + 1e-2 * std::round(v * 100);  // steps of 1e-2 Hz
  Recording recording;
  recording.info.channels.resize(1);
  recording.info.time.rate_hz = 1;
  recording.samples = {y};
  CharacterizeOptions options;
  options.data = SampleKind::frequency;
  options.nominal_frequency = 1e7;
  const Characterization result = characterize(recording, options);
  const ChannelQuality& quality = result.channels[0].quality;
  REQUIRE(quality.resolution);
  CHECK(*quality.resolution == Approx(1e-9).epsilon(1e-6));
  CHECK(std::abs(quality.mean) < 1e-10);
  CHECK(quality.maximum == Approx((*std::max_element(y.begin(), y.end()) - 1e7) / 1e7));
}

TEST_CASE("a frequency far from nominal, or with none, is doubted in a sentence") {
  Recording recording;
  recording.info.channels.resize(1);
  recording.info.time.rate_hz = 1;
  const std::vector<double> noise = white(2000, 7);
  recording.samples = {noise};
  CharacterizeOptions options;
  options.data = SampleKind::frequency;
  for (const auto& [nominal, scatter, sentence] :
       {std::tuple{0.0, 1e3, "without `nominal_frequency`"},
        {0.0, 1e-3, "like frequencies or periods themselves, not like fractions"},
        {5e6, 1.0, "far from the nominal"},
        {1e7, 1.0, ""}}) {
    options.nominal_frequency = nominal;
    for (std::size_t t = 0; t < noise.size(); ++t) recording.samples[0][t] = 1e7 + scatter * noise[t];
    const auto problems = characterize(recording, options).channels[0].findings;
    CAPTURE(nominal);
    REQUIRE(problems.empty() == (nominal == 1e7));
    if (!problems.empty()) CHECK(problems[0].sentence.find(sentence) != std::string::npos);
  }
}

TEST_CASE("the model of half a quartz clock is its Allan curve, no narrow filter's") {
  NEEDS_SHARED("data/clock_ocxo10mhz_freq.npy");
  Recording recording;
  recording.info.channels.resize(1);
  recording.info.time.rate_hz = 1;
  recording.samples = {test::npy(test::shared("data/clock_ocxo10mhz_freq.npy")).values};
  recording.samples[0].resize(recording.samples[0].size() / 2);
  CharacterizeOptions options;
  options.data = SampleKind::frequency;
  options.nominal_frequency = 1e7;
  const Characterization result = characterize(recording, options);
  const ChannelResult& channel = result.channels[0];
  REQUIRE(channel.fit);
  for (const AllanPoint& p : channel.allan.points) {
    if (p.tau_s > 8) break;
    CAPTURE(p.tau_s);
    const auto m = static_cast<double>(p.m);
    CHECK(*model_deviation(*channel.fit, channel.allan.type, m, 1) == Approx(p.deviation).epsilon(0.35));
  }
}

TEST_CASE("a record of five samples is called too short, not constant") {
  const Characterization result = of(white(5, 8));
  const auto& problems = result.channels[0].findings;
  REQUIRE_FALSE(problems.empty());
  CHECK(std::none_of(problems.begin(), problems.end(),
                     [](const Finding& p) { return p.sentence.find("constant") != std::string::npos; }));
}

TEST_CASE("a step that was taken out is in the verdict") {
  std::vector<double> y = white(60000, 5);
  for (std::size_t t = 30000; t < y.size(); ++t) y[t] += 0.02;
  const Characterization step = of(y);
  REQUIRE(step.channels[0].fit->events.size() == 1);
  CHECK(step.channels[0].fit->events[0].size == Approx(0.02).epsilon(0.05));
  CHECK(verdict_of(step).find("Use it with caution: a step was taken out") != std::string::npos);
}

TEST_CASE("a heading that wraps is said to wrap, and its two ends are no steps, levels or spikes") {
  std::vector<double> y = white(40000, 6);
  for (std::size_t t = 0; t < y.size(); ++t) {
    const double heading = 180 + 100 * y[t] + 30 * std::sin(6.28318530717958648 * static_cast<double>(t) / 2500);
    y[t] = heading > 180 ? heading - 360 : heading;
  }
  const std::vector<Finding> found = findings_of(of(y).channels[0]);
  const auto has = [&](const char* code) {
    return std::any_of(found.begin(), found.end(), [&](const Finding& one) { return one.code == code; });
  };
  CHECK(has("phase_wraps"));
  for (const char* code : {"event", "events_left_in", "spiky", "spikes_kept", "strength_change"}) {
    INFO(code);
    CHECK_FALSE(has(code));
  }
}

TEST_CASE("more channels than fit into memory in the end are refused before they are analysed") {
  Recording recording;
  recording.info.channels.resize(5001);
  recording.info.time.rate_hz = 100;
  recording.samples.assign(5001, {1, 2, 3});
  const std::string said = test::refusal(recording, {});
  CHECK(said == "E0707 5001 channels are more than are characterized at a time, 5000");
}

TEST_CASE("one wild sample of 1e300 is missing, counted and said, and nothing but such is no record") {
  std::vector<double> y = white(20000, 8);
  const double clean = *(*of(y).channels[0].fit)[Term::white].value;
  y[7000] = 1e300;
  const Characterization one = of(y);
  REQUIRE(one.channels[0].fit);
  CHECK(*(*one.channels[0].fit)[Term::white].value == Approx(clean).epsilon(1e-3));
  CHECK(one.channels[0].quality.beyond == 1);
  CHECK(one.channels[0].quality.missing == 1);
  CHECK(one.channels[0].quality.standard_deviation == Approx(0.01).epsilon(0.05));
  REQUIRE(one.channels[0].quality.findings.size() == 1);
  CHECK_THAT(one.channels[0].quality.findings[0].sentence, Catch::Contains("1 sample beyond 1×10¹⁰⁰"));
  for (double& v : y) v *= 1e160;
  const Characterization all = of(y);
  CHECK_FALSE(all.channels[0].fit);
  CHECK(all.channels[0].quality.beyond == 20000);
}

TEST_CASE("noise of 1e-200 or 1e-310 is refused with the reason, not fitted and not called zero") {
  for (const double factor : {1e-198, 1e-308}) {
    std::vector<double> y = white(20000, 9);
    for (double& v : y) v *= factor;
    const Characterization tiny = of(y);
    CHECK_FALSE(tiny.channels[0].fit);
    CHECK(tiny.channels[0].spectrum.value.empty());
    CHECK(std::isnan(tiny.channels[0].quality.standard_deviation));
    CHECK_THAT(tiny.channels[0].findings[0].sentence, Catch::Contains("do not fit into a double"));
  }
}

TEST_CASE("the interval of a correlation time holds the time, where other terms are in doubt") {
  NEEDS_SHARED("data/array_airq3_rtp201908_1min.csv");
  CharacterizeOptions options;
  options.wanted = {false, true, false, true};
  const Characterization air = characterize(test::shared("data/array_airq3_rtp201908_1min.csv").string(), options);
  int processes = 0;
  for (const ChannelResult& c : air.channels) {
    if (!c.fit || !c.fit->gauss_markov || !c.fit->gauss_markov->in_model) continue;
    ++processes;
    CAPTURE(c.channel.name);
    for (const Coefficient& part : {c.fit->gauss_markov->tau_s, c.fit->gauss_markov->sigma}) {
      CHECK(part.ci95.low <= *part.value);
      CHECK(*part.value <= part.ci95.high);
    }
  }
  CHECK(processes > 0);
}

TEST_CASE("what is no phase, no fraction of a frequency and no rate is doubted, with the option that fits") {
  Recording recording;
  recording.info.channels.resize(1);
  recording.info.time.rate_hz = 1;
  const std::vector<double> noise = white(4000, 8);
  CharacterizeOptions options;
  const auto found = [&](SampleKind data, std::string_view code) {
    options.data = data;
    const Characterization result = characterize(recording, options);
    for (const Finding& one : result.channels[0].findings)
      if (one.code == code) return one.help.at(0).options.at(0).option;
    return std::string();
  };
  recording.samples = {noise};
  for (double& v : recording.samples[0]) v = 1e-7 * (1 + 1e-11 * v);
  CHECK(found(SampleKind::phase, "frequency_mean") == "data");
  CHECK(found(SampleKind::frequency, "frequency_mean") == "nominal_frequency");
  CHECK(found(SampleKind::rate, "frequency_mean").empty());
  recording.samples = {noise};
  CHECK(found(SampleKind::rate, "looks_integrated").empty());
  double sum = 0;
  for (double& v : recording.samples[0]) v = sum += v;
  CHECK(found(SampleKind::rate, "looks_integrated") == "data");
  CHECK(found(SampleKind::frequency, "looks_integrated") == "data");
  CHECK(found(SampleKind::phase, "looks_integrated").empty());
  // What the unit says of them.
  const auto unit_of = [&](std::string name, std::string unit, const std::vector<double>& samples) {
    recording.info.channels[0] = {std::move(name), std::move(unit)};
    recording.samples = {samples};
    return found(SampleKind::rate, "integral_unit");
  };
  const std::vector<double> walk = recording.samples[0];
  CHECK(unit_of("gx", "rad", noise) == "channel_scale");
  CHECK(unit_of("delta_angle[0]", "rad", noise) == "channel_scale");
  CHECK(unit_of("gyro_x", "deg", walk) == "data");
  CHECK(found(SampleKind::rate, "looks_integrated").empty());
  CHECK(unit_of("roll", "deg", noise).empty());
  CHECK(unit_of("gx", "rad/s", noise).empty());
  CHECK(unit_of("phase", "s", noise) == "data");
  std::vector<double> periods(noise.size());
  for (std::size_t i = 0; i < noise.size(); ++i) periods[i] = 1e-7 * (1 + 1e-11 * noise[i]);
  CHECK(unit_of("period", "s", periods).empty());
  CHECK(found(SampleKind::rate, "frequency_mean") == "data");
}

namespace {

Characterization of_rounded_walk(double walk, double white_level, std::uint64_t seed) {
  constexpr double kRate = 100, kWhite = 0.01;  // deviation of white()
  Recording recording;
  recording.info.channels = {{"heading", "deg/s"}};
  recording.info.time.rate_hz = kRate;
  std::vector<double> samples = white(20000, seed);
  const std::vector<double> on_top = white(20000, seed + 1000);
  double sum = 0;
  const double step = walk / std::sqrt(kRate), level = white_level * walk / (std::numbers::pi * std::sqrt(kRate));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    sum += step * samples[i] / kWhite;
    samples[i] = std::round((sum + level * on_top[i] / kWhite) / (0.5 * step)) * 0.5 * step;
  }
  recording.samples = {samples};
  return characterize(recording, {});
}

}  // namespace

TEST_CASE("a rounded angle that is called a rate looks integrated, a rate with white noise does not") {
  constexpr double kWalk = 2e-3;
  std::size_t angles = 0, rates = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    angles += has(of_rounded_walk(kWalk, 0, seed).channels[0].findings, "looks_integrated") ? 1 : 0;
    rates += has(of_rounded_walk(kWalk, 2, seed).channels[0].findings, "looks_integrated") ? 1 : 0;
  }
  CHECK(angles >= 10);
  CHECK(rates <= 1);
}

TEST_CASE("white noise of which nothing shows stays within what the record has") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Characterization result = of_rounded_walk(2e-3, 0, seed);
    const Coefficient& n = (*result.channels[0].fit)[Term::white];
    const double most = result.channels[0].allan.points.at(0).deviation * 0.1;  // N of that deviation, at 100 Hz
    INFO("seed " << seed);
    if (n.value) CHECK(*n.value < 10 * most);
    if (n.value) CHECK(n.ci95.high < 1000 * most);
  }
}

TEST_CASE("rounded samples: N is that of the sensor, and a simulation of the model gives it back") {
  constexpr std::size_t kRecords = 10;
  constexpr double kSd = 0.05, kTruth = 5e-3;
  for (const double ratio : {0.1, 0.5, 0.75, 1.0, 1.5}) {
    std::size_t held = 0, again = 0, said = 0;
    for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
      test::Gaussian gauss(100 + seed);
      const double step = ratio * kSd, offset = 0.3 * kSd * static_cast<double>(seed);
      std::vector<double> y(40000);
      for (double& v : y) v = step * std::round((offset + kSd * gauss()) / step);
      const Characterization result = of(y);
      REQUIRE(result.channels[0].fit);
      const NoiseFit& fit = *result.channels[0].fit;
      const Coefficient& white = fit[Term::white];
      held += white.value && white.ci95.low <= kTruth && kTruth <= white.ci95.high;
      said += has(fit.findings, "rounding_in_n");
      // The curve of the fit stays that of the samples: rounding is in it.
      CHECK(*model_deviation(fit, DeviationType::oadev, 1, 0.01) ==
            Approx(result.channels[0].allan.points[0].deviation).epsilon(0.03));
      const SensorModel model = sensor_model_from(result.channels[0], result.log);
      const NoiseFit shown = detail::sensor_model_fit(model);
      CHECK(*model_deviation(shown, DeviationType::oadev, 1, 0.01) ==
            Approx(*model_deviation(fit, DeviationType::oadev, 1, 0.01)).epsilon(1e-9));
      ArraySimulation simulation;
      simulation.rate_hz = 100;
      simulation.samples = y.size();
      simulation.seed = seed;
      simulation.sensors = {{"x", model, {1}}};
      ArraySimulator simulator(simulation);
      std::vector<double> simulated;
      for (auto block = simulator.next(8192); !block.empty(); block = simulator.next(8192))
        simulated.insert(simulated.end(), block[0].begin(), block[0].end());
      const NoiseFit second = *of(simulated).channels[0].fit;
      again += white.value && second[Term::white].value &&
               std::abs(*second[Term::white].value / *white.value - 1) < 3 * white.relative_sd;
    }
    CAPTURE(ratio);
    CHECK(held >= kRecords - 1);
    CHECK(again >= kRecords - 1);
    CHECK(said >= (ratio >= 0.5 ? kRecords : 0));
  }
}

TEST_CASE("rounding that is no white noise, or none at all, is not taken out of N") {
  test::Gaussian gauss(7);
  std::vector<double> y(40000);
  for (double& v : y) v = 0.05 * gauss();
  CHECK_FALSE(has(of(y).channels[0].fit->findings, "rounding_in_n"));
  // A walk of a hundredth of a step: what is measured is the rounding, and it is slow.
  double level = 0;
  for (double& v : y) v = std::round((level += 0.01 * gauss()));
  const ChannelResult slow = of(y).channels[0];
  CHECK(slow.fit->rounding == 0);
  CHECK_FALSE(has(slow.fit->findings, "rounding_in_n"));
  // Every value twice: the rounding is held with it.
  for (std::size_t t = 0; t < y.size(); ++t) y[t] = t % 2 == 0 ? std::round(5 * gauss()) : y[t - 1];
  CHECK(of(y).channels[0].fit->rounding == 0);
}

TEST_CASE("a clock's phase has fractional frequencies, whatever the unit of its time") {
  test::Gaussian gauss(11);
  double level = 0;
  std::vector<double> phase(20000);
  for (double& x : phase) x = (level += 1e-11 * gauss()) + 2e-11 * gauss();
  std::vector<double> h;
  for (const auto& [unit, factor] : {std::pair{"s", 1.0}, {"ns", 1e9}, {"µs", 1e6}}) {
    Recording recording;
    recording.info.channels.resize(1);
    recording.info.channels[0].name = "x";
    recording.info.channels[0].unit = unit;
    recording.info.time.rate_hz = 1;
    recording.samples = {phase};
    for (double& x : recording.samples[0]) x *= factor;
    CharacterizeOptions options;
    options.data = SampleKind::phase;
    const Characterization result = characterize(recording, options);
    CHECK(result.channels[0].channel.unit == "1");
    CHECK(result.channels[0].allan.points[0].deviation == Approx(3.6e-11).epsilon(0.05));
    const std::vector<PowerLaw> laws = power_laws(*result.channels[0].fit);
    REQUIRE(laws.size() == 5);
    CHECK(laws[2].h.value.value_or(0) == Approx(2e-22).epsilon(0.1));  // 2 sd² dt
    h.push_back(laws[0].h.value.value_or(0));
  }
  CHECK(h[1] == Approx(h[0]).epsilon(1e-6));
  CHECK(h[2] == Approx(h[0]).epsilon(1e-6));
  CHECK(detail::power_law_unit(2, "1") == "Hz⁻³");
  CHECK(detail::power_law_unit(-1, "Hz") == "(Hz)²");
}
