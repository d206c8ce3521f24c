// Means over what is present: whole curves, no bias, intervals that cover, whatever the noise and the gaps.

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/allan/detail/kernels/present_points.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

constexpr std::size_t kSamples = 4096;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// `share` of the samples missing, in gaps of geometric length.
std::vector<double> punched(std::vector<double> y, double share, double length, test::Gaussian& g) {
  bool missing = false;
  for (double& v : y) {
    const double change = missing ? (1 - share) / length : share / length;  // length 1: each by itself
    if (length == 1)
      missing = g.uniform() < share;
    else if (g.uniform() < change / (1 - share))
      missing = !missing;
    if (missing) v = kNaN;
  }
  return y;
}

struct Sums {
  double holed = 0, whole = 0;
  int points = 0, held = 0;
};

/// Per octave up to m = 512, of records of one noise with gaps of one kind.
std::vector<Sums> sums_of(const Mixture& theta, double share, double length, bool streamed) {
  test::NoiseSource source(kSamples, 1, 5);
  std::vector<Sums> sums(10);
  for (int r = 0; r < 120; ++r) {
    const auto y = source.record(std::sqrt(theta[0]), std::sqrt(theta[1]), std::sqrt(theta[2]));
    const auto holed = punched(y, share, length, source.gauss());
    const AllanCurve whole = streamed ? pyramid_deviation(y, 1) : allan_deviation(y, 1);
    AllanCurve curve = streamed ? pyramid_deviation(holed, 1) : allan_deviation(holed, 1);
    add_intervals(curve, theta);
    REQUIRE(curve.points.size() >= sums.size());
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const AllanPoint& p = curve.points[k];
      REQUIRE(p.m == std::uint64_t{1} << k);
      const double truth = std::sqrt(allan_variance(theta, static_cast<double>(p.m), 1));
      sums[k].holed += p.deviation * p.deviation;
      sums[k].whole += whole.points[k].deviation * whole.points[k].deviation;
      ++sums[k].points;
      sums[k].held += p.ci95.low <= truth && truth <= p.ci95.high ? 1 : 0;
    }
  }
  return sums;
}

}  // namespace

TEST_CASE("at 10 % missing every octave to a quarter of the record is there, at once and in one pass") {
  test::NoiseSource source(20000, 1, 3);
  for (const double length : {1.0, 5.0, 50.0})
    for (int r = 0; r < 20; ++r) {
      const auto y = punched(source.record(1, 0.1, 0.001), 0.1, length, source.gauss());
      for (const AllanCurve& curve : {allan_deviation(y, 1), pyramid_deviation(y, 1)}) {
        REQUIRE(curve.points.size() >= 13);
        for (std::size_t k = 0; k < 13; ++k) CHECK(curve.points[k].m == std::uint64_t{1} << k);
      }
    }
}

TEST_CASE("missing samples bias no noise, and intervals cover") {
  const double shares[][2] = {{0.05, 1}, {0.1, 1}, {0.3, 1}, {0.1, 20}, {0.3, 20}};
  for (const Mixture& theta : {Mixture{1}, Mixture{0, 1}, Mixture{0, 0, 1}, Mixture{1, 0.01, 1e-4}})
    for (const auto& [share, length] : shares)
      for (const bool streamed : {false, true}) {
        CAPTURE(theta, share, length, streamed);
        int points = 0, held = 0;
        const auto sums = sums_of(theta, share, length, streamed);
        for (std::size_t k = 0; k < sums.size(); ++k) {
          CAPTURE(k);
          // Below m = 64 the scatter of 120 records is under 0.5 %.
          if (k < 6) CHECK(std::sqrt(sums[k].holed / sums[k].whole) == Approx(1).margin(0.015));
          points += sums[k].points;
          held += sums[k].held;
        }
        CHECK(held > 0.93 * points);
        CHECK(held < 0.98 * points);
      }
}

TEST_CASE("missing samples bias no averaging time between the octaves either") {
  AllanOptions list;
  list.grid = TauGrid::list;
  list.taus_s = {3, 6, 12, 24};
  for (const Mixture& theta : {Mixture{1}, Mixture{0, 0, 1}}) {
    test::NoiseSource source(kSamples, 1, 8);
    std::vector<double> holed(4), whole(4);
    for (int r = 0; r < 100; ++r) {
      const auto y = source.record(std::sqrt(theta[0]), std::sqrt(theta[1]), std::sqrt(theta[2]));
      const AllanCurve one = allan_deviation(y, 1, list);
      const AllanCurve other = allan_deviation(punched(y, 0.3, 1, source.gauss()), 1, list);
      REQUIRE(one.points.size() == 4);
      REQUIRE(other.points.size() == 4);
      for (std::size_t k = 0; k < 4; ++k) {
        whole[k] += one.points[k].deviation * one.points[k].deviation;
        holed[k] += other.points[k].deviation * other.points[k].deviation;
      }
    }
    for (std::size_t k = 0; k < 4; ++k) {
      CAPTURE(theta, list.taus_s[k]);
      CHECK(std::sqrt(holed[k] / whole[k]) == Approx(1).margin(0.015));
    }
  }
}

TEST_CASE("missing samples are noted where they are more than one in a hundred") {
  test::Gaussian gauss(12);
  std::vector<double> y(200);
  for (double& v : y) v = gauss();
  y[50] = y[150] = kNaN;
  CHECK(allan_deviation(y, 1).notes.empty());
  y[100] = kNaN;
  REQUIRE(allan_deviation(y, 1).notes.size() == 1);
  CHECK_THAT(allan_deviation(y, 1).notes[0], Catch::StartsWith("1.5 % of the samples are missing"));
}

TEST_CASE("noise that what is missing hides is left out, or its interval says so") {
  test::Gaussian gauss(9);
  // Differences of white noise: sigma²(m) falls with 1/m², what 10 % missing samples add with 1/m.
  std::vector<double> y(20000);
  double last = gauss();
  for (double& v : y) {
    const double next = gauss();
    v = next - last;
    last = next;
  }
  const auto holed = punched(y, 0.1, 1, gauss);
  for (AllanCurve curve : {allan_deviation(holed, 1), pyramid_deviation(holed, 1)}) {
    add_intervals(curve, {0, 0, 0, 1});
    CHECK(curve.points.size() < 13);
    for (const AllanPoint& p : curve.points) {
      const double m = static_cast<double>(p.m), truth = std::sqrt(3) / m;
      CAPTURE(p.m, p.deviation, truth);
      CHECK(p.ci95.low < truth * 1.35);  // what just shows is what scattered upwards
      CHECK(p.ci95.high > truth * 0.95);
    }
    REQUIRE_FALSE(curve.notes.empty());
    CHECK(curve.notes.back().find("gaps leave no term") != std::string::npos);
  }
}

TEST_CASE("the way with missing samples meets the way with none") {
  test::NoiseSource source(5000, 1, 4);
  auto y = source.record(1, 1, 0.01);
  const AllanCurve whole = allan_deviation(y, 1), passed = pyramid_deviation(y, 1);
  y.push_back(kNaN);  // too much of a window of one or two
  const AllanCurve holed = allan_deviation(y, 1), holed_pass = pyramid_deviation(y, 1);
  CHECK(whole.points[3].inflation == 1);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(holed.points[k].deviation == Approx(whole.points[k].deviation).epsilon(1e-12));
    CHECK(holed_pass.points[k].deviation == Approx(passed.points[k].deviation).epsilon(1e-12));
  }
}

TEST_CASE("what missing samples add lies on the power law of the octaves beside, in any unit") {
  for (const double unit : {1e-6, 1.0, 1e6})
    for (const double power : {-0.5, 0.0, 1.0}) {
      // S^2(m) = unit m^power at 2 and 4: sigma^2(1) = S^2(2), and the mean with 2 sigma^2(2) is S^2(4).
      const double at_two = unit * std::pow(2, power), at_four = unit * std::pow(4, power);
      PresentTerms octave;
      octave.imbalance = octave.squares = 1;
      octave.terms = octave.starts = 1;
      MissingSamples missing;
      missing.add_octave(1, octave, at_two);
      missing.add_octave(2, octave, (2 * at_four - at_two) / 2);
      PresentTerms terms;
      terms.terms = 1000;
      terms.squares = 2000 * unit;
      terms.shortfall = 20;  // c = 0.01
      INFO("unit " << unit << " power " << power);
      CHECK(missing.corrected(3, terms, 2, 1.0 / 3, 100).added ==
            Approx(0.01 * unit * std::pow(3, power)).epsilon(1e-12));
    }
}
