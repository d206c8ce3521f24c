// The cornered hat and the dynamic Allan deviation: simulated devices of known noise, identities, bad input.

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/error.hpp"
#include "tests/support/code_of.hpp"

using namespace libchar;

namespace {

using Records = std::vector<std::vector<double>>;

/// White rates of these standard deviations, over a walk that all share.
Records devices(const std::vector<double>& sigma, std::size_t samples, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Records out(sigma.size(), std::vector<double>(samples));
  double common = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    common += normal(random);
    for (std::size_t c = 0; c < sigma.size(); ++c) out[c][i] = common + sigma[c] * normal(random);
  }
  return out;
}

AllanOptions at_times(std::vector<double> taus) {
  AllanOptions options;
  options.grid = TauGrid::list;
  options.taus_s = std::move(taus);
  return options;
}

double allan_variance_of(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
  return std::pow(allan_deviation(d, 1, at_times({4})).points[0].deviation, 2);
}

}  // namespace

TEST_CASE("cornered hat: of three devices half of two differences less the third") {
  const Records r = devices({1, 2, 3}, 500, 1);
  const CorneredHat hat = cornered_hat(r, 1, at_times({4}));
  const double ab = allan_variance_of(r[0], r[1]), ac = allan_variance_of(r[0], r[2]),
               bc = allan_variance_of(r[1], r[2]);
  CHECK(hat.devices[0][0].variance == Approx((ab + ac - bc) / 2).epsilon(1e-12));
  CHECK(hat.devices[1][0].variance == Approx((ab + bc - ac) / 2).epsilon(1e-12));
  CHECK(hat.devices[2][0].variance == Approx((ac + bc - ab) / 2).epsilon(1e-12));
  CHECK(hat.devices[2][0].terms == 493);
}

TEST_CASE("cornered hat: exact variances give themselves back, for any number of devices") {
  // Orthogonal sequences: the variances of differences are exactly sums.
  for (const std::size_t n : {3U, 4U, 6U}) {
    Records r(n, std::vector<double>(64 * n + 16, 0.0));
    for (std::size_t c = 0; c < n; ++c)
      for (std::size_t i = 0; i < 32; ++i) r[c][64 * c + 2 * i + 4] = double(c + 1);
    const CorneredHat hat = cornered_hat(r, 1, at_times({1}));
    for (std::size_t c = 0; c < n; ++c) {
      const double own = allan_deviation(r[c], 1, at_times({1})).points[0].deviation;
      CAPTURE(n, c);
      CHECK(hat.devices[c][0].variance == Approx(own * own).epsilon(0.04));
    }
  }
}

TEST_CASE("cornered hat: simulated devices of known noise, with the stated standard deviation") {
  const std::vector<double> sigma = {1, 1.5, 2, 3};
  constexpr int kRuns = 200;
  std::vector<double> sum(4), squares(4), stated(4);
  for (int run = 0; run < kRuns; ++run) {
    const CorneredHat hat = cornered_hat(devices(sigma, 1000, 10 + static_cast<unsigned>(run)), 1, at_times({4}));
    for (std::size_t c = 0; c < 4; ++c) {
      const HatPoint& p = hat.devices[c][0];
      sum[c] += p.variance;
      squares[c] += p.variance * p.variance;
      stated[c] += p.variance_sd / kRuns;
    }
  }
  for (std::size_t c = 0; c < 4; ++c) {
    const double mean = sum[c] / kRuns, sd = std::sqrt(squares[c] / kRuns - mean * mean);
    CAPTURE(c);
    CHECK(mean == Approx(sigma[c] * sigma[c] / 4).margin(3 * sd / std::sqrt(double(kRuns))));
    CHECK(stated[c] == Approx(sd).epsilon(0.2));
  }
}

TEST_CASE("cornered hat: negative variances stay negative and are said") {
  int negative = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const CorneredHat hat = cornered_hat(devices({0.01, 3, 3}, 200, seed), 1, at_times({16}));
    const HatPoint& quiet = hat.devices[0][0];
    if (quiet.variance >= 0) {
      CHECK(quiet.status == HatStatus::not_resolved);
      continue;
    }
    ++negative;
    CHECK(quiet.status == HatStatus::negative);
    CHECK(std::isnan(quiet.deviation));
    REQUIRE_FALSE(hat.notes.empty());
    CHECK(hat.notes.back().find("are negative") != std::string::npos);
  }
  CHECK(negative > 3);
  CHECK(negative < 18);
}

TEST_CASE("cornered hat: what is common does not count, order and other statistics neither") {
  const Records r = devices({1, 2, 3}, 800, 3);
  Records moved = r;
  for (std::size_t i = 0; i < 800; ++i)
    for (auto& record : moved) record[i] += std::sin(0.01 * double(i)) * 4;
  const Records turned = {r[2], r[0], r[1]};
  for (const DeviationType type : {DeviationType::oadev, DeviationType::mdev, DeviationType::ohdev}) {
    AllanOptions options = at_times({4});
    options.type = type;
    const CorneredHat a = cornered_hat(r, 1, options), b = cornered_hat(moved, 1, options),
                      c = cornered_hat(turned, 1, options);
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(b.devices[k][0].variance == Approx(a.devices[k][0].variance).epsilon(1e-9));
      CHECK(c.devices[(k + 1) % 3][0].variance == Approx(a.devices[k][0].variance).epsilon(1e-10));
    }
  }
}

TEST_CASE("cornered hat of differences: the hat's values without noise of measurement, right ones with it") {
  const Records r = devices({1, 2, 3}, 5000, 4);
  Records d(3, std::vector<double>(5000));
  for (std::size_t i = 0; i < 5000; ++i)
    for (std::size_t c = 0; c < 3; ++c) d[c][i] = r[c][i] - r[(c + 1) % 3][i];
  const CorneredHat plain = cornered_hat(r, 1, at_times({4})),
                    by_covariance = cornered_hat_of_differences(d, 1, at_times({4}));
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(by_covariance.devices[c][0].variance == Approx(plain.devices[c][0].variance).epsilon(1e-9));
  const Records noise = devices({2, 2, 2}, 5000, 5);
  for (std::size_t i = 0; i < 5000; ++i)
    for (std::size_t c = 0; c < 3; ++c) d[c][i] += noise[c][i] - noise[c][0];
  // Its common walk has no place here: of independent noises.
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < 5000; ++i)
    for (std::size_t c = 0; c < 3; ++c) d[c][i] = r[c][i] - r[(c + 1) % 3][i] + 2 * normal(random);
  const CorneredHat noisy = cornered_hat_of_differences(d, 1, at_times({4}));
  for (std::size_t c = 0; c < 3; ++c) {
    const HatPoint& p = noisy.devices[c][0];
    const double truth = double((c + 1) * (c + 1)) / 4;
    CHECK(std::fabs(p.variance - truth) < 0.35);
  }
}

TEST_CASE("cornered hat of differences: the noise of the measurements is in what it states") {
  // Phases of two clocks of white frequency against one without noise, each difference with a counter's white phase.
  constexpr int kRuns = 150;
  constexpr std::size_t kReadings = 1000;
  const std::vector<double> taus = {1, 8, 32};
  for (const double counter : {0.0, 3.0, 30.0}) {
    std::map<double, std::array<double, 4>> of;  // sum, squares, stated variance, resolved
    std::mt19937 random(21);
    std::normal_distribution<double> normal;
    for (int run = 0; run < kRuns; ++run) {
      Records x(3, std::vector<double>(kReadings)), d = x;
      for (std::size_t i = 1; i < kReadings; ++i)
        for (std::size_t c = 1; c < 3; ++c) x[c][i] = x[c][i - 1] + normal(random);
      for (std::size_t i = 0; i < kReadings; ++i)
        for (std::size_t c = 0; c < 3; ++c) d[c][i] = x[c][i] - x[(c + 1) % 3][i] + counter * normal(random);
      AllanOptions options = at_times(taus);
      options.data = DataKind::phase;
      const CorneredHat hat = cornered_hat_of_differences(d, 1, options);
      for (const HatPoint& p : hat.devices[0]) {
        auto& [sum, squares, stated, resolved] = of[p.tau_s];
        sum += p.variance / kRuns;
        squares += p.variance * p.variance / kRuns;
        stated += p.variance_sd * p.variance_sd / kRuns;
        resolved += p.status == HatStatus::resolved ? 1.0 / kRuns : 0;
      }
    }
    for (const auto& [tau_s, found] : of) {
      const auto& [sum, squares, stated, resolved] = found;
      CAPTURE(counter, tau_s, sum, resolved);
      // More where the noise changes from the counters' to the devices', which have fewer degrees of freedom.
      const double over_real = std::sqrt(stated / (squares - sum * sum));
      CHECK(over_real > 0.75);
      CHECK(over_real < 1.6);
      CHECK(resolved < 0.07);
    }
  }
}

TEST_CASE("dynamic deviation: each window is its own record") {
  const auto r = devices({1, 1, 1}, 1000, 7)[0];
  const DynamicDeviation dynamic = dynamic_deviation(r, 0.5, {200, 100});
  REQUIRE(dynamic.windows.size() == 9);
  for (std::size_t k = 0; k < 9; ++k) {
    const DynamicWindow& window = dynamic.windows[k];
    CHECK(window.from_s == 50 * double(k));
    CHECK(window.to_s == 50 * double(k) + 100);
    const std::vector<double> piece(r.begin() + static_cast<std::ptrdiff_t>(100 * k),
                                    r.begin() + static_cast<std::ptrdiff_t>(100 * k + 200));
    const AllanCurve alone = allan_deviation(piece, 0.5);
    REQUIRE(window.curve.points.size() == alone.points.size());
    for (std::size_t i = 0; i < alone.points.size(); ++i)
      CHECK(window.curve.points[i].deviation == alone.points[i].deviation);
  }
  CHECK(dynamic_deviation(r, 1, {200, 0}).windows.size() == 9);
  // A step of noise is seen where it is.
  auto louder = devices({1, 1, 1}, 2000, 8)[0];
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < 2000; ++i) louder[i] = (i < 1000 ? 1 : 5) * normal(random);
  const DynamicDeviation seen = dynamic_deviation(louder, 1, {500, 500});
  CHECK(seen.windows[1].curve.points[0].deviation == Approx(1).epsilon(0.15));
  CHECK(seen.windows[2].curve.points[0].deviation == Approx(5).epsilon(0.15));
}

TEST_CASE("dynamic deviation: gaps empty a window, and it is said") {
  auto r = devices({1, 1, 1}, 600, 10)[0];
  for (std::size_t i = 200; i < 400; ++i) r[i] = std::nan("");
  const DynamicDeviation dynamic = dynamic_deviation(r, 1, {200, 200});
  CHECK(dynamic.windows[0].curve.points.size() > 3);
  CHECK(dynamic.windows[1].curve.points.empty());
  REQUIRE(dynamic.notes.size() == 1);
  CHECK(dynamic.notes[0].find("1 of 3 windows") == 0);
}

TEST_CASE("devices: what is not possible is refused in a sentence") {
  const Records r = devices({1, 1, 1}, 100, 11);
  const Records two(r.begin(), r.begin() + 2);
  CHECK(test::code_of([&] { cornered_hat(two, 1); }) == "E0870");
  Records uneven = r;
  uneven[1].pop_back();
  CHECK(test::code_of([&] { cornered_hat(uneven, 1); }) == "E0870");
  AllanOptions options;
  options.type = DeviationType::mtie;
  CHECK(test::code_of([&] { cornered_hat(r, 1, options); }) == "E0870");
  CHECK(test::code_of([&] { cornered_hat_of_differences(r, 1, options); }) == "E0870");
  CHECK(test::code_of([&] { dynamic_deviation(r[0], 1, {7, 1}); }) == "E0871");
  CHECK(test::code_of([&] { dynamic_deviation(r[0], 1, {101, 1}); }) == "E0871");
  const std::vector<double> nothing(100, std::nan(""));
  CHECK(test::code_of([&] { dynamic_deviation(nothing, 1, {20, 10}); }) == "E0401");
}
