// Moments as the Allan bench and characterization use them: whole blocks straight from memory, the
// rest one by one.

#include "libchar/core/moments.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

using namespace libchar;

namespace {

std::vector<double> record(std::size_t n, double offset) {
  std::mt19937_64 engine(n);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = offset + normal(engine) * normal(engine);
  return y;
}

void check_same(const Moments& a, const Moments& b) {
  CHECK(a.count() == b.count());
  CHECK(a.missing() == b.missing());
  CHECK(a.mean() == b.mean());
  CHECK(a.variance() == b.variance());
  CHECK(a.skewness() == b.skewness());
  CHECK(a.kurtosis() == b.kurtosis());
  CHECK(a.minimum() == b.minimum());
  CHECK(a.maximum() == b.maximum());
}

}  // namespace

TEST_CASE(
    "moments: any split of the record gives the same bits, with and without missing samples") {
  for (const bool holes : {false, true}) {
    auto y = record(30011, 1e6);
    if (holes)
      for (const std::size_t i : {0UL, 4095UL, 4096UL, 9000UL, 9001UL, 30010UL})
        y[i] = std::nan("");
    Moments whole;
    whole.push(y);
    CHECK(whole.missing() == (holes ? 6 : 0));
    for (const std::size_t piece : {1UL, 7UL, 4095UL, 4096UL, 4097UL, 10000UL}) {
      Moments parts;
      for (std::size_t i = 0; i < y.size(); i += piece)
        parts.push(std::span(y).subspan(i, std::min(piece, y.size() - i)));
      check_same(whole, parts);
    }
  }
}

TEST_CASE("moments against long double sums, offset 1e9 sigma included") {
  for (const double offset : {0.0, 9.81, 987654321.125}) {
    const auto y = record(50000, offset);
    long double mean = 0, m2 = 0, m3 = 0, m4 = 0;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const double v : y) mean += v - static_cast<long double>(y[0]);
    mean /= static_cast<long double>(y.size());
    for (const double v : y) {
      const long double d = (v - static_cast<long double>(y[0])) - mean;
      m2 += d * d;
      m3 += d * d * d;
      m4 += d * d * d * d;
      low = std::min(low, v);
      high = std::max(high, v);
    }
    const auto n = static_cast<long double>(y.size());
    Moments m;
    m.push(y);
    CHECK(m.mean() == Approx(static_cast<double>(mean + y[0])).epsilon(1e-15));
    CHECK(m.variance() == Approx(static_cast<double>(m2 / (n - 1))).epsilon(1e-14));
    CHECK(m.skewness() ==
          Approx(static_cast<double>(std::sqrt(n) * m3 / std::pow(m2, 1.5L))).epsilon(1e-10));
    CHECK(m.kurtosis() == Approx(static_cast<double>(n * m4 / (m2 * m2))).epsilon(1e-13));
    CHECK(m.minimum() == low);
    CHECK(m.maximum() == high);
  }
}
