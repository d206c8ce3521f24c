// Signs, axes and units of a tilt, judged by the gyroscope against the direction of gravity.
#include "libchar/replay/detail/plan/tilt_check.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

struct Instant {
  double rate = 0, x = 0, z = 0, reference = 0;
};

/// What is said of 200 s at 100 Hz of a tilt that swings by `swing` rad, each instant changed by `change`; "": nothing.
std::string said(double swing, const std::function<void(Instant&)>& change, double disturbance = 0) {
  test::Gaussian normal(5);
  Eigen::MatrixXd samples(3, 20000), truth(1, 20000);
  double wind = 0;
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    const double t = 0.01 * static_cast<double>(k), w = 2 * M_PI * 0.11;
    const double angle = swing * std::sin(w * t);
    wind += 0.05 * (normal() - wind);
    Instant now{swing * w * std::cos(w * t) + 0.05 + 0.01 * normal(),
                9.81 * std::sin(angle) + 0.1 * normal() + disturbance * wind, 9.81 * std::cos(angle) + 0.1 * normal(),
                angle};
    change(now);
    samples.col(k) << now.rate, now.x, now.z;
    truth(k) = now.reference;
  }
  detail::TiltCheck check({0, 1, 2}, 100);
  // Blocks of any length tell the same.
  check.push(samples.leftCols(777), truth.leftCols(777));
  check.push(samples.rightCols(samples.cols() - 777), truth.rightCols(samples.cols() - 777));
  Findings warnings;
  check.tell(warnings);
  const Finding* found = warnings.find("tilt_contradicts");
  return found == nullptr ? "" : found->sentence;
}

}  // namespace

TEST_CASE("tilt check: signs, exchanged axes, units and another axis are told") {
  CHECK_THAT(said(0.8, [](Instant& i) { i.rate = -i.rate; }), Contains("the other way"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.x = -i.x; }), Contains("the other way"));
  CHECK_THAT(said(0.8, [](Instant& i) { std::swap(i.x, i.z); }), Contains("the other way"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.rate *= 57.29578; }), Contains("57.3 times"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.rate = 0.01 * std::sin(1000 * i.z); }), Contains("another axis"));
}

TEST_CASE("tilt check: a delay of the gyroscope or of the accelerometers is told, a lever arm is none") {
  const auto late_by = [](bool gyroscope) {
    return [gyroscope, line = std::vector<Instant>()](Instant& now) mutable {
      line.push_back(now);
      const Instant& late = line[line.size() > 20 ? line.size() - 21 : 0];
      if (gyroscope)
        now.rate = late.rate;
      else
        now = {now.rate, late.x, late.z};
    };
  };
  CHECK_THAT(said(0.8, late_by(true)), Contains("gyroscope is") && Contains("late"));
  CHECK_THAT(said(0.8, late_by(false)), Contains("accelerometers are 20") && Contains(" ms late"));
  CHECK(said(0.3, [](Instant& i) { i.x *= 1.1; }).empty());
}

TEST_CASE("tilt check: a right set-up is silent, also at rest, with an offset, in other units and when shaken") {
  const auto as_it_is = [](Instant&) {};
  CHECK(said(0.8, as_it_is).empty());
  CHECK(said(0, as_it_is).empty());
  CHECK(said(0.8, as_it_is, 10).empty());
  CHECK(said(0.8, [](Instant& i) { i.rate += 0.3; }).empty());
  CHECK(said(0.8, [](Instant& i) {
          i.x /= 9.81;
          i.z /= 9.81;
        }).empty());
}

TEST_CASE("tilt check: the reference tells which is wrong, or is wrong itself") {
  CHECK_THAT(said(0.8, [](Instant& i) { i.rate = -i.rate; }), Contains("it is the gyroscope"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.x = -i.x; }), Contains("it is the accelerometers"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.rate *= 57.29578; }), Contains("it is the gyroscope"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.reference = -i.reference; }), Contains("the reference turns the other way"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.reference /= 57.29578; }), Contains("0.0175 times"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.rate *= 1.2; }), Contains("reads 1.2 times"));
  CHECK_THAT(said(0.8, [](Instant& i) { i.reference = std::sin(1000 * i.z); }), Contains("another angle"));
  for (const double offset : {0.2, 3.1, std::nan("")})  // wraps, and without a reference
    CHECK(said(0.8, [&](Instant& i) { i.reference = std::remainder(i.reference + offset, 2 * M_PI); }).empty());
}
