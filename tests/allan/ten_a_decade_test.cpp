
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/allan/allan_deviation.hpp"

using namespace libchar;

namespace {

std::vector<double> walk_and_noise(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> out(n);
  double walk = 0;
  for (double& x : out) x = normal(random) + (walk += 0.01 * normal(random));
  return out;
}

const AllanPoint* point_at(const AllanCurve& curve, std::uint64_t m) {
  for (const AllanPoint& p : curve.points)
    if (p.m == m) return &p;
  return nullptr;
}

}  // namespace

TEST_CASE("ten a decade: octaves stay as they were, and every decade has ten times and more") {
  const auto x = walk_and_noise(50000, 1);
  const AllanCurve octaves = allan_deviation(x, 0.01);
  AllanCurve fine = octaves;
  add_ten_a_decade(x, {}, 1U << 20U, fine);
  for (const AllanPoint& p : octaves.points) {
    REQUIRE(point_at(fine, p.m) != nullptr);
    CHECK(point_at(fine, p.m)->deviation == p.deviation);
  }
  for (std::size_t i = 1; i < fine.points.size(); ++i) CHECK(fine.points[i].m > fine.points[i - 1].m);
  const auto between = [&](double from, double to) {
    return std::count_if(fine.points.begin(), fine.points.end(),
                         [&](const AllanPoint& p) { return p.tau_s >= from && p.tau_s < to; });
  };
  CHECK(between(0.1, 1) >= 10);
  CHECK(between(1, 10) >= 10);
  CHECK(between(10, 100) >= 10);
}

TEST_CASE("ten a decade: values and intervals are those of the full overlap within a fifth of their sd") {
  const auto x = walk_and_noise(40000, 2);
  const AllanCurve octaves = allan_deviation(x, 0.01);
  AllanCurve fine = octaves;
  add_ten_a_decade(x, {}, 1U << 20U, fine);
  AllanOptions list;
  list.grid = TauGrid::list;
  for (const AllanPoint& p : fine.points) list.taus_s.push_back(p.tau_s);
  AllanCurve exact = allan_deviation(x, 0.01, list);
  const Mixture theta{0.01, 0, 0.01};
  add_intervals(fine, theta);
  add_intervals(exact, theta);
  REQUIRE(exact.points.size() == fine.points.size());
  for (std::size_t i = 0; i < fine.points.size(); ++i) {
    const AllanPoint &f = fine.points[i], &e = exact.points[i];
    CAPTURE(f.m);
    REQUIRE(f.m == e.m);
    CHECK(std::abs(std::log(f.deviation / e.deviation)) < 0.2 / std::sqrt(2 * e.edf) + 1e-12);
    CHECK(f.edf == Approx(e.edf).epsilon(0.02));
  }
}

TEST_CASE("ten a decade: a long record has the same points, from the first mean of eight on") {
  const auto x = walk_and_noise(40000, 5);
  const AllanCurve octaves = allan_deviation(x, 0.01);
  AllanCurve whole = octaves, lengthy = octaves;
  add_ten_a_decade(x, {}, 1U << 20U, whole);
  add_ten_a_decade(x, {}, 1000, lengthy);
  std::size_t added = 0;
  for (const AllanPoint& p : lengthy.points) {
    const AllanPoint* same = point_at(whole, p.m);
    REQUIRE(same != nullptr);
    CHECK(p.deviation == Approx(same->deviation).epsilon(1e-12));
    added += point_at(octaves, p.m) == nullptr ? 1 : 0;
  }
  CHECK(added > 15);
  CHECK(lengthy.points.size() < whole.points.size());
  // Long is what is longer than the number.
  AllanCurve as_long = octaves;
  add_ten_a_decade(x, {}, x.size(), as_long);
  CHECK(as_long.points.size() == whole.points.size());
}

TEST_CASE("ten a decade: limits hold, and missing samples are exact or nothing") {
  auto x = walk_and_noise(20000, 3);
  AllanOptions options;
  options.tau_min_s = 0.5;
  options.tau_max_s = 20;
  AllanCurve fine = limited(allan_deviation(x, 0.01), options);
  add_ten_a_decade(x, options, 1U << 20U, fine);
  CHECK(fine.points.front().tau_s >= 0.5 - 1e-9);
  CHECK(fine.points.back().tau_s <= 20 + 1e-9);
  for (std::size_t i = 3000; i < 3100; ++i) x[i] = std::numeric_limits<double>::quiet_NaN();
  const AllanCurve octaves = allan_deviation(x, 0.01);
  fine = octaves;
  add_ten_a_decade(x, {}, 1U << 20U, fine);
  AllanOptions list;
  list.grid = TauGrid::list;
  list.taus_s = {1.0};
  REQUIRE(point_at(fine, 100) != nullptr);
  CHECK(point_at(fine, 100)->deviation == allan_deviation(x, 0.01, list).points[0].deviation);
  fine = octaves;
  add_ten_a_decade(x, {}, 1000, fine);
  CHECK(fine.points.size() == octaves.points.size());
}

TEST_CASE("ten a decade: a wild first sample counts as in the full overlap") {
  auto x = walk_and_noise(100000, 4);
  x[0] = 3000;  // in one term of m = 20: with every fourth of them it would be in four times its share
  AllanCurve fine = allan_deviation(x, 0.01);
  add_ten_a_decade(x, {}, 1U << 20U, fine);
  AllanOptions list;
  list.grid = TauGrid::list;
  for (const AllanPoint& p : fine.points) list.taus_s.push_back(p.tau_s);
  const AllanCurve exact = allan_deviation(x, 0.01, list);
  REQUIRE(exact.points.size() == fine.points.size());
  for (std::size_t i = 0; i < fine.points.size(); ++i)
    if (fine.points[i].m < 1000) CHECK(fine.points[i].deviation <= exact.points[i].deviation * 1.02);
}

TEST_CASE("ten a decade: points that the octaves' sums give besides are those of their own sums") {
  const auto x = walk_and_noise(50000, 3);
  AllanOptions more;
  more.more_factors = detail::exact_factors({}, 0.01, x.size());
  CHECK(more.more_factors == std::vector<std::uint64_t>{3, 5, 6, 10, 13});
  AllanCurve both = allan_deviation(x, 0.01, more);
  std::vector<AllanPoint> between;
  AllanCurve octaves = both;
  std::erase_if(octaves.points, [&](const AllanPoint& p) {
    if ((p.m & (p.m - 1)) != 0) between.push_back(p);
    return (p.m & (p.m - 1)) != 0;
  });
  AllanCurve apart = octaves;
  add_ten_a_decade(x, {}, 1U << 20U, apart);
  add_ten_a_decade(x, {}, 1U << 20U, octaves, between);
  REQUIRE(apart.points.size() == octaves.points.size());
  for (std::size_t i = 0; i < apart.points.size(); ++i) {
    CHECK(apart.points[i].m == octaves.points[i].m);
    CHECK(apart.points[i].terms == octaves.points[i].terms);
    CHECK(apart.points[i].deviation == octaves.points[i].deviation);
  }
}
