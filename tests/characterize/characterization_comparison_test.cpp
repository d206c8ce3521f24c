// Two characterizations, term by term.

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/characterize/compare/characterization_check.hpp"
#include "libchar/core/error.hpp"
#include "libchar/report/json/json_report.hpp"
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

ReportedCharacterization summary(const Coefficient& white,
                                 const Coefficient& flicker,
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

TermDifference flicker_difference(const Coefficient& a, const Coefficient& b) {
  return compare_characterizations(summary(known(1, 0.01), a), summary(known(1, 0.01), b))
      .channels[0]
      .terms[1]
      .difference;
}

}  // namespace

TEST_CASE("compared terms: ratio, interval and p of two values") {
  const auto c = compare_characterizations(summary(known(1, 0.03), known(2, 0.1)),
                                           summary(known(1.2, 0.04), known(2, 0.1)));
  const ComparedTerm& white = c.channels[0].terms[0];
  CHECK(*white.ratio == Approx(1.2));
  // Independent: standard deviations .03 and .04 make .05.
  CHECK(white.ratio_ci95.low == Approx(1.2 * std::exp(-1.96 * 0.05)));
  CHECK(white.ratio_ci95.high == Approx(1.2 * std::exp(1.96 * 0.05)));
  CHECK(*white.p == Approx(std::erfc(std::log(1.2) / 0.05 / std::sqrt(2.0))).epsilon(1e-3));
  CHECK(white.difference == TermDifference::larger);
  CHECK(c.channels[0].terms[1].difference == TermDifference::not_resolved);
  CHECK_THAT(c.verdict, Contains("1 of 2 terms differ") && Contains("larger"));
}

TEST_CASE("compared terms: equal sensors are called different in at most 1 % of comparisons") {
  test::Gaussian gauss(5);
  int different = 0;
  constexpr int kPairs = 2000;
  for (int i = 0; i < kPairs; ++i) {
    const auto drawn = [&](double sd) { return known(std::exp(sd * gauss()), sd); };
    const auto c = compare_characterizations(summary(drawn(0.01), drawn(0.2)),
                                             summary(drawn(0.02), drawn(0.1)));
    bool any = false;
    for (const ComparedTerm& t : c.channels[0].terms)
      any = any || t.difference != TermDifference::not_resolved;
    different += any ? 1 : 0;
  }
  CHECK(different <= 38);  // 20, and four standard deviations
  CHECK(different >= 4);   // the share is used
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
    return failures(
        compare_characterizations(summary(known(1, 0.01), a), summary(known(1, 0.01), b)),
        parse_characterization_check(check));
  };
  CHECK(failed(known(1, 0.05), known(1.3, 0.05), "bias_instability+10%").size() == 1);
  CHECK(failed(known(1, 0.05), known(1.3, 0.05), "x:bias_instability+20%").empty());
  CHECK(failed(known(1, 0.05), known(1.3, 0.5), "bias_instability+0%").empty());
  CHECK(failed(limit(1), known(1.3, 0.05), "bias_instability+0%").size() == 1);
  CHECK(failed(limit(1), known(1.3, 0.05), "bias_instability+50%").empty());
  CHECK_THAT(failed(known(1, 0.05), known(1, 0.05, Status::misfit), "bias_instability+0%").at(0),
             Contains("not to be relied on"));
  CHECK_THROWS_WITH(failed(known(1, 0.05, Status::misfit), known(9, 0.05), "bias_instability+0%"),
                    Contains("E0923"));
  CHECK_THROWS_WITH(failed(known(1, 0.05), known(9, 0.05), "y:bias_instability+0%"),
                    Contains("E0922") && Contains("neither report"));
}

TEST_CASE("compared channels: units are converted, unlike ones and missing channels said") {
  auto b = summary(known(std::numbers::pi / 180, 0.01), known(1, 0.1), "rad/s");
  const auto c = compare_characterizations(summary(known(1, 0.01), known(1, 0.1)), b);
  CHECK(*c.channels[0].terms[0].ratio == Approx(1));
  CHECK_THAT(c.channels[0].remarks.at(0), Contains("Unit"));
  b.channels[0].unit = "Pa";
  CHECK(compare_characterizations(summary(known(1, 0.01), known(1, 0.1)), b)
            .channels[0]
            .terms.empty());
  b.channels[0].name = "y";
  const auto apart = compare_characterizations(summary(known(1, 0.01), known(1, 0.1)), b);
  REQUIRE(apart.channels.size() == 2);
  CHECK_FALSE(apart.channels[0].in_b);
  CHECK_FALSE(apart.channels[1].in_a);
  CHECK_THAT(apart.verdict, Contains("No channel is in both"));
}

TEST_CASE("compared channels: another band or shape is said") {
  auto b = summary(known(1, 0.01), known(1, 0.1));
  b.channels[0].band.whole = false;
  b.channels[0].band.top_hz = 3;
  b.channels[0].shape = "boxcar of 4";
  b.channels[0].events = 2;
  const auto c = compare_characterizations(summary(known(1, 0.01), known(1, 0.1)), b);
  REQUIRE(c.channels[0].remarks.size() == 3);
  CHECK_THAT(c.channels[0].remarks[0], Contains("up to 3") && Contains("the whole spectrum"));
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
  const auto same = compare_characterizations(a, a);
  CHECK_THAT(same.verdict, Contains("No difference beyond chance"));
}

TEST_CASE("what is no characterization is refused in a sentence") {
  CHECK_THROWS_WITH(
      parse_characterization_report(R"({"format":"replay-report","version":1})", "r.json"),
      Contains("r.json") && Contains("E0771") && Contains("replay-report"));
  CHECK_THROWS_AS(parse_characterization_report(R"({"format":"noise-fit","version":1})", "r.json"),
                  Error);
  CHECK_THROWS_AS(
      parse_characterization_report(
          R"({"format":"noise-fit","version":1,"channels":[{"name":"x","goodness":{},"white_noise":{}}]})",
          "r.json"),
      Error);
  CHECK_THROWS_AS(parse_characterization_report("[1,", "r.json"), Error);
}
