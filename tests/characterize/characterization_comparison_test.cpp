// Characterizations side by side: terms, averaging times, pairs of channels.

#include "libchar/characterize/compare/characterization_comparison.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/error.hpp"
#include "libchar/report/html/html_report.hpp"
#include "tests/report/synthetic.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

Coefficient known(double value, double sd, Status status = Status::detected) {
  Coefficient c;
  c.status = status;
  c.value = value;
  c.relative_sd = sd;
  c.ci95 = {value * std::exp(-1.96 * sd), value * std::exp(1.96 * sd)};
  return c;
}

Coefficient limit(double upper) {
  Coefficient c;
  c.status = Status::not_detected;
  c.upper95 = upper;
  return c;
}

ReportedCharacterization summary(const Coefficient& white, const Coefficient& flicker,
                                 const std::string& unit = "deg/s") {
  ReportedCharacterization out;
  ReportedChannel c;
  c.name = "x";
  c.unit = unit;
  c.fitted = true;
  c.rate_hz = 100;
  c.duration_s = 1000;
  c.band.top_hz = 50;
  c.term[0] = white;
  c.term[1] = flicker;
  out.channels.push_back(c);
  return out;
}

CharacterizationComparison compared(const ReportedCharacterization& a, const ReportedCharacterization& b) {
  std::vector<ReportedCharacterization> sides = {a, b};
  for (std::size_t i = 0; i < 2; ++i)
    if (sides[i].name.empty()) sides[i].file = sides[i].name = i == 0 ? "A" : "B";
  return compare_characterizations(std::move(sides));
}

TermDifference flicker_difference(const Coefficient& a, const Coefficient& b) {
  return compared(summary(known(1, 0.01), a), summary(known(1, 0.01), b)).groups[0].terms[1].differences[1];
}

CharacterizationCompareOptions wanting(const std::string& channel) {
  CharacterizationCompareOptions out;
  out.channels = {channel};
  return out;
}

/// A channel with a measured curve, `factor` times that of white noise.
ReportedCharacterization measured(const std::string& name, const std::string& channel, const std::string& unit,
                                  std::uint64_t seed, double white, double floor = 0) {
  test::Gaussian gauss(seed);
  std::vector<double> record(8192);
  double slow = 0;
  for (double& y : record) y = white * gauss() + (slow += floor * gauss());
  AllanOptions options;
  options.grid = TauGrid::octave;
  AllanCurve curve = allan_deviation(record, 0.01, options);
  Mixture mixture{};
  mixture[0] = 0.01 * white * white;
  mixture[2] = floor * floor / 0.01;
  add_intervals(curve, mixture);
  ReportedCharacterization out;
  out.file = out.name = name;
  ReportedChannel c;
  c.name = channel;
  c.unit = unit;
  c.curve = curve.points;
  out.channels.push_back(c);
  return out;
}

}  // namespace

TEST_CASE("compared terms: ratio, interval and p of two values") {
  const auto c = compared(summary(known(1, 0.03), known(2, 0.1)), summary(known(1.2, 0.04), known(2, 0.1)));
  const ComparedTerm& term = c.groups[0].terms[0];
  const detail::TermRatio& white = term.ratios[1];
  CHECK(*white.ratio == Approx(1.2));
  // Independent: standard deviations .03 and .04 make .05.
  CHECK(white.ci95.low == Approx(1.2 * std::exp(-1.96 * 0.05)));
  CHECK(white.ci95.high == Approx(1.2 * std::exp(1.96 * 0.05)));
  CHECK(*white.p == Approx(std::erfc(std::log(1.2) / 0.05 / std::sqrt(2.0))).epsilon(1e-3));
  CHECK(term.differences[1] == TermDifference::larger);
  CHECK(term.lowest.best == 0);
  CHECK(term.lowest.not_apart.empty());
  CHECK(c.groups[0].terms[1].differences[1] == TermDifference::not_resolved);
  CHECK_THAT(c.verdict, Contains("Lowest N: A; B: A or B, not distinguished"));
}

TEST_CASE("compared terms: equal sensors are called different in at most 1 % of comparisons") {
  test::Gaussian gauss(5);
  int different = 0;
  constexpr int kPairs = 2000;
  for (int i = 0; i < kPairs; ++i) {
    const auto drawn = [&](double sd) { return known(std::exp(sd * gauss()), sd); };
    const auto c = compared(summary(drawn(0.01), drawn(0.2)), summary(drawn(0.02), drawn(0.1)));
    bool any = false;
    for (const ComparedTerm& t : c.groups[0].terms) any = any || t.differences[1] != TermDifference::not_resolved;
    different += any ? 1 : 0;
  }
  CHECK(different <= 38);  // 20, and four standard deviations
  CHECK(different >= 4);   // the share is used
}

TEST_CASE("limits of a data sheet find a channel by the name of any side, or by what it measures") {
  const auto limit_for = [](const std::string& channels, std::vector<std::string> chosen = {}) {
    std::vector<ReportedCharacterization> sides = {summary(known(2, 0.01), known(1, 0.01)),
                                                   summary(known(1, 0.01), known(1, 0.01))};
    for (std::size_t s = 0; s < 2; ++s) {
      sides[s].file = sides[s].name = s == 0 ? "A" : "B";
      sides[s].channels.push_back(sides[s].channels[0]);
      sides[s].channels[0].name = s == 0 ? "wx" : "imu.angular_velocity.x";
      sides[s].channels[1].name = s == 0 ? "wy" : "imu.angular_velocity.y";
    }
    CharacterizationCompareOptions options;
    options.limits = parse_limits("format: noise-limits\nversion: 1\nlimits:\n  - channels: [" + channels +
                                      "]\n    white_noise: {value: 180, unit: deg/√h}\n",
                                  "sheet.yaml");
    options.channels = std::move(chosen);
    const auto found = compare_characterizations(std::move(sides), options);
    return found.groups[0].terms[0].limit.value_or(0);
  };
  for (const char* name : {"gyro_x", "wx", "imu.angular_velocity.x", "gyro_x, gyro_y", "wx, wy"}) {
    CAPTURE(name);
    CHECK(limit_for(name) == Approx(3));
    CHECK(limit_for(name, {"gyro_x"}) == Approx(3));
  }
  CHECK_THROWS_WITH(limit_for("gyro_q"), Contains("no such channel"));
}

TEST_CASE("compared terms: limits are compared as limits") {
  using enum TermDifference;
  CHECK(flicker_difference(known(2, 0.05), limit(1)) == smaller);
  CHECK(flicker_difference(limit(1), known(2, 0.05)) == larger);
  CHECK(flicker_difference(known(2, 0.05), limit(3)) == not_resolved);
  CHECK(flicker_difference(known(2, 0.05), limit(1.9)) == not_resolved);
  CHECK(flicker_difference(limit(1), limit(100)) == not_judged);
  CHECK(flicker_difference(known(2, 0.05, Status::misfit), known(9, 0.05)) == not_judged);
  CHECK(flicker_difference(known(2, 0.05), known(9, 0.05, Status::undetermined)) == not_judged);
  CHECK(flicker_difference(known(2, 0.05), {}) == only_one);
}

TEST_CASE("compared terms: an interval that reaches zero claims nothing") {
  Coefficient wide = known(5, 0.3);
  wide.ci95.low = 0;
  CHECK(flicker_difference(known(1, 0.05), wide) == TermDifference::not_resolved);
}

TEST_CASE("checks of a comparison fail beyond chance only, and where B lost what A knew") {
  const auto failed = [](const Coefficient& a, const Coefficient& b, const std::string& check) {
    return failures(compared(summary(known(1, 0.01), a), summary(known(1, 0.01), b)),
                    parse_characterization_check(check));
  };
  CHECK(failed(known(1, 0.05), known(1.3, 0.05), "bias_instability+10%").size() == 1);
  CHECK(failed(known(1, 0.05), known(1.3, 0.05), "x:bias_instability+20%").empty());
  CHECK(failed(known(1, 0.05), known(1.3, 0.5), "bias_instability+0%").empty());
  CHECK(failed(limit(1), known(1.3, 0.05), "bias_instability+0%").size() == 1);
  CHECK(failed(limit(1), known(1.3, 0.05), "bias_instability+50%").empty());
  CHECK_THAT(failed(known(1, 0.05), known(1, 0.05, Status::misfit), "bias_instability+0%").at(0),
             Contains("not to be relied on"));
  CHECK_THROWS_WITH(failed(known(1, 0.05, Status::misfit), known(9, 0.05), "bias_instability+0%"), Contains("E0923"));
  CHECK_THROWS_WITH(failed(known(1, 0.05), known(9, 0.05), "y:bias_instability+0%"),
                    Contains("E0922") && Contains("neither report"));
}

TEST_CASE("compared channels: units are converted, unlike ones and missing channels said") {
  auto b = summary(known(std::numbers::pi / 180, 0.01), known(1, 0.1), "rad/s");
  const auto a = summary(known(1, 0.01), known(1, 0.1));
  const auto c = compared(a, b);
  CHECK(*c.groups[0].terms[0].ratios[1].ratio == Approx(1));
  CHECK_THAT(c.remarks.at(0), Contains("unit deg/s in A, rad/s in B"));
  b.channels[0].unit = "Pa";
  CHECK_THROWS_WITH(compared(a, b), Contains("E0976") && Contains("x of A is in deg/s") && Contains("x of B is in Pa"));
  auto both = b;
  both.channels.push_back(a.channels[0]);
  const auto apart = compared(a, both);
  REQUIRE(apart.groups.size() == 1);
  CHECK_THAT(apart.remarks.at(0), Contains("x: only in B (Pa)"));
}

TEST_CASE("compared channels: kind and axis pair them, whatever their names") {
  const auto sheet = [](const std::string& gyroscope) {
    ReportedCharacterization out = summary(known(3, 0.01), known(1, 0.1));
    out.channels[0].name = gyroscope;
    out.file = out.name = "sheet";
    return out;
  };
  for (const char* name : {"wx", "GyrX", "angular_velocity.x", "imu_gyro_x"}) {
    CAPTURE(name);
    auto a = summary(known(1, 0.01), known(1, 0.1), "rad/s");
    a.channels[0].name = name;
    const auto c = compared(a, sheet("gyro_x"));
    REQUIRE(c.groups.size() == 1);
    CHECK(c.groups[0].name == "gyro_x");
    CHECK(c.groups[0].axis == "x");
    // Another axis is another channel.
    CHECK_THROWS_WITH(compared(a, sheet("gyro_y")), Contains("E0976"));
    // Without an axis it stands for each.
    CHECK(compared(a, sheet("gyroscope")).groups[0].candidates.size() == 2);
  }
}

TEST_CASE("compared channels: axes of several sides are taken together as well") {
  auto a = summary(known(1, 0.01), known(1, 0.1)), b = summary(known(2, 0.01), known(1, 0.1));
  for (auto* side : {&a, &b}) {
    side->channels[0].name = "gyro_x";
    for (const char* name : {"gyro_y", "gyro_z"}) {
      side->channels.push_back(side->channels[0]);
      side->channels.back().name = name;
    }
  }
  a.channels[2].term[0] = known(3, 0.01);
  const auto c = compared(a, b);
  REQUIRE(c.groups.size() == 4);
  CHECK(c.groups[0].name == "gyro (x, y, z)");
  CHECK(c.groups[0].of_axes);
  CHECK(*c.groups[0].terms[0].values[0].value == Approx(std::sqrt((1 + 1 + 9) / 3.0)));
  CHECK(c.groups[0].terms[0].lowest.best == 0);
  CHECK(c.groups[3].terms[0].lowest.best == 1);
  const auto one = compare_characterizations({a, b}, wanting("gyro_y"));
  CHECK(one.groups.size() == 1);
  CHECK_THROWS_WITH(compare_characterizations({a, b}, wanting("gyro_w")), Contains("E0977"));
}

TEST_CASE("compared curves: the lowest at each averaging time, of known truth") {
  // White 1 and 3, walk .05 and .005 a step: they cross at about tau = 3 s² … where both are 1.
  const auto c = compare_characterizations({measured("quick", "wx", "deg/s", 1, 1, 0.1),
                                            measured("slow", "gyro_x", "deg/s", 2, 3, 0.01),
                                            measured("worse", "GyrX", "deg/s", 3, 30, 0.3)});
  REQUIRE(c.groups.size() == 1);
  const ComparedGroup& group = c.groups[0];
  REQUIRE(group.ranges.size() >= 2);
  CHECK(group.ranges[0].lowest == std::vector<std::size_t>{0});
  CHECK(group.ranges[1].lowest == std::vector<std::size_t>{1});
  // .01 / tau + .1² tau / .03 = .09 / tau + .01² tau / .03: tau = .49 s.
  CHECK(group.ranges[0].to_s > 0.3);
  CHECK(group.ranges[0].to_s < 0.8);
  CHECK_THAT(c.verdict, Contains("gyro_x: quick is lowest below") && Contains("slow from"));
}

TEST_CASE("compared curves: of equal sensors none is the lowest, in 99 of 100") {
  int called = 0;
  constexpr int kDraws = 400;
  for (int i = 0; i < kDraws; ++i) {
    std::vector<ReportedCharacterization> sides;
    for (int k = 0; k < 3; ++k)
      sides.push_back(measured(std::string(1, static_cast<char>('a' + k)), "x", "deg/s",
                               static_cast<std::uint64_t>(1000 + 3 * i + k), 1));
    const auto c = compare_characterizations(std::move(sides));
    bool any = false;
    for (const ComparedGroup::Time& time : c.groups[0].times) any = any || time.lowest.not_apart.size() < 2;
    called += any ? 1 : 0;
  }
  CHECK(called <= 12);  // 4, and four standard deviations
}

TEST_CASE("compared sensors: what is not to be relied on is not the lowest, and is said") {
  auto moved = measured("moved", "x", "deg/s", 1, 0.1);
  Finding motion = finding("moves_throughout", "The sensor moves throughout.");
  motion.subject = "x";
  moved.findings.push_back(motion);
  const auto c =
      compare_characterizations({moved, measured("b", "x", "deg/s", 2, 1), measured("c", "x", "deg/s", 3, 3)});
  CHECK_FALSE(c.groups[0].candidates[0].takes_part);
  CHECK(c.groups[0].ranges[0].lowest == std::vector<std::size_t>{1});
  CHECK_THAT(c.verdict, Contains("moved is left out: motion throughout"));
  // Each reason once, whoever has it.
  std::vector<ReportedCharacterization> many = {measured("b", "x", "deg/s", 2, 1), measured("c", "x", "deg/s", 3, 3)};
  for (const char* name : {"d", "e", "f", "g", "h"}) {
    many.push_back(moved);
    many.back().name = name;
  }
  CHECK_THAT(compare_characterizations(many).verdict, Contains("d, e, f and 2 more are left out: motion throughout."));
  moved.findings[0].severity = Severity::caution;
  const auto careful =
      compare_characterizations({moved, measured("b", "x", "deg/s", 2, 1), measured("c", "x", "deg/s", 3, 3)});
  CHECK_THAT(careful.verdict, Contains("moved is lowest") && Contains("Check moved first: motion throughout"));
}

TEST_CASE("compared channels: another band or shape is said") {
  auto b = summary(known(1, 0.01), known(1, 0.1));
  b.channels[0].band.whole = false;
  b.channels[0].band.top_hz = 3;
  b.channels[0].shape = "boxcar of 4";
  b.channels[0].events = 2;
  const auto c = compared(summary(known(1, 0.01), known(1, 0.1)), b);
  REQUIRE(c.remarks.size() == 3);
  CHECK_THAT(c.remarks[0], Contains("up to 3") && Contains("the whole spectrum"));
}

TEST_CASE("a report that was written is read back and equals itself") {
  Characterization imu = test::synthetic_imu();
  const std::string text = dump_json(json_report(imu));
  const auto a = parse_characterization_report(text, "a/report.json");
  REQUIRE(a.channels.size() == imu.channels.size());
  for (std::size_t i = 0; i < a.channels.size(); ++i) {
    CHECK(a.channels[i].name == imu.channels[i].channel.name);
    if (!imu.channels[i].fit) continue;
    for (std::size_t t = 0; t < kTerms; ++t) {
      CHECK(a.channels[i].term[t].value == imu.channels[i].fit->term[t].value);
      CHECK(a.channels[i].term[t].status == imu.channels[i].fit->term[t].status);
    }
  }
  const auto same = compare_characterizations({a, a});
  for (const ComparedGroup& group : same.groups) {
    for (const ComparedGroup::Time& time : group.times) CHECK(time.lowest.not_apart.size() == 1);
    for (const ComparedTerm& term : group.terms)
      if (term.lowest.best) CHECK(term.lowest.not_apart.size() == 1);
  }
  CHECK_THAT(same.verdict, Contains("Not distinguished"));
}

TEST_CASE("what is no characterization is refused in a sentence") {
  CHECK_THROWS_WITH(parse_characterization_report(R"({"format":"replay-report","version":1})", "r.json"),
                    Contains("r.json") && Contains("E0771") && Contains("replay-report"));
  CHECK_THROWS_AS(parse_characterization_report(R"({"format":"noise-fit","version":1})", "r.json"), Error);
  CHECK_THROWS_AS(
      parse_characterization_report(
          R"({"format":"noise-fit","version":1,"channels":[{"name":"x","goodness":{},"white_noise":{}}]})", "r.json"),
      Error);
  CHECK_THROWS_AS(parse_characterization_report("[1,", "r.json"), Error);
}
