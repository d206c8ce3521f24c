// Coefficients held against limits: only what is known decides.

#include "libchar/characterize/limits.hpp"

#include <catch2/catch.hpp>

#include "tests/report/synthetic.hpp"

using namespace libchar;

namespace {

Coefficient known(double low, double value, double high, Status status = Status::detected) {
  Coefficient c;
  c.status = status;
  c.value = value;
  c.ci95 = {low, high};
  return c;
}

Coefficient upper_limit(double upper, Status status = Status::not_detected) {
  Coefficient c;
  c.status = status;
  c.upper95 = upper;
  return c;
}

}  // namespace

TEST_CASE("a limit is decided by the whole interval, and not by what cannot be relied on") {
  using enum LimitStatus;
  CHECK(judge_limit(known(1, 2, 3), 3.5) == pass);
  CHECK(judge_limit(known(1, 2, 3), 3) == pass);
  CHECK(judge_limit(known(1, 2, 3), 2.5) == not_decided);
  CHECK(judge_limit(known(1, 2, 3), 1.5) == not_decided);
  CHECK(judge_limit(known(1, 2, 3), 1) == not_decided);
  CHECK(judge_limit(known(1, 2, 3), 0.5) == fail);
  CHECK(judge_limit(upper_limit(1), 2) == pass);
  CHECK(judge_limit(upper_limit(3), 2) == not_decided);
  for (const Status status : {Status::undetermined, Status::misfit}) {
    CHECK(judge_limit(known(1, 2, 3, status), 10) == not_decided);
    CHECK(judge_limit(known(1, 2, 3, status), 0.1) == not_decided);
    CHECK(judge_limit(upper_limit(1, status), 2) == not_decided);
  }
  CHECK(judge_limit({}, 1) == not_decided);
}

TEST_CASE("a characterization against a data sheet: every judgement says why") {
  const Characterization imu = test::synthetic_imu();
  const std::string& first = imu.channels[0].channel.name;
  const LimitReport report =
      judge_limits(imu, parse_limits("format: noise-limits\nversion: 1\nsensor: X\nlimits:\n  - channels: [" + first +
                                         "]\n    white_noise: {value: 1e-9, unit: U·√s}\n"
                                         "    bias_instability: {value: 1e9, unit: U}\n",
                                     "x.yaml"));
  REQUIRE(report.judgements.size() == 2);
  CHECK(report.sensor == "X");
  CHECK(report.judgements[0].status == LimitStatus::fail);
  CHECK_THAT(report.judgements[0].sentence, Catch::Contains("whole 95 % interval is above"));
  CHECK(report.judgements[1].status == LimitStatus::pass);
  CHECK_THAT(report.verdict, Catch::Contains("1 of 2 limits fails: white noise of " + first));
}

TEST_CASE("a channel without a fit decides no limit") {
  Characterization imu = test::synthetic_imu();
  imu.channels[0].fit.reset();
  const LimitReport report =
      judge_limits(imu, parse_limits("format: noise-limits\nversion: 1\nlimits:\n  - channels: [" +
                                         imu.channels[0].channel.name + "]\n    white_noise: {value: 1, unit: U·√s}\n",
                                     "x.yaml"));
  CHECK(report.count(LimitStatus::not_decided) == 1);
  CHECK_THAT(report.judgements[0].sentence, Catch::Contains("no value"));
}
