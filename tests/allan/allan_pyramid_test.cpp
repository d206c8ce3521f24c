// The streaming curve against direct sums: values, counts, pieces, missing samples, extremes.

#include "libchar/allan/allan_pyramid.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <span>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/detail/kernels/octave_terms.hpp"
#include "libchar/core/error.hpp"
#include "tests/allan/present_reference.hpp"

using namespace libchar;

namespace {

std::vector<double> noise(std::size_t n, unsigned seed, double offset = 0, double drift = 0) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  double walk = 0;
  for (std::size_t i = 0; i < n; ++i) {
    walk += 0.01 * normal(engine);
    y[i] = offset + normal(engine) + walk + drift * double(i) / double(n);
  }
  return y;
}

AllanCurve pyramid_of(const std::vector<double>& y, std::size_t piece = 0, double dt = 0.5) {
  AllanPyramid pyramid;
  if (piece == 0) piece = y.size();
  for (std::size_t i = 0; i < y.size(); i += piece)
    pyramid.push(std::span(y).subspan(i, std::min(piece, y.size() - i)));
  return pyramid.finish(dt);
}

std::uint64_t stride(std::uint64_t m) { return m >= 8 ? m / 4 : 1; }

/// Samples less the first: the reference adds whole windows.
std::vector<double> less_first(std::vector<double> y) {
  double first = std::nan("");
  for (const double v : y)
    if (std::isnan(first) && std::isfinite(v)) first = v;
  for (double& v : y) v -= first;
  return y;
}

void check_against_direct(const std::vector<double>& y, double limit) {
  const AllanCurve curve = pyramid_of(y);
  const test::PresentReference reference(less_first(y), stride);
  std::size_t k = 0;
  for (std::uint64_t m = 1; 2 * m <= y.size(); m *= 2) {
    const test::PresentTruth t = reference.at(m, 2, stride(m));
    INFO("n " << y.size() << " m " << m);
    if (t.terms == 0 || t.variance < 0) continue;
    REQUIRE(k < curve.points.size());
    const AllanPoint& point = curve.points[k];
    const auto deviation = static_cast<double>(std::sqrt(t.variance));
    CHECK(point.m == m);
    CHECK(point.terms == t.terms);
    CHECK(std::fabs(point.deviation - deviation) <= limit * deviation);
    CHECK(point.inflation == Approx(static_cast<double>(t.inflation)).epsilon(1e-9));
    ++k;
  }
  CHECK(k == curve.points.size());
}

void check_same(const AllanCurve& a, const AllanCurve& b, double factor = 1) {
  REQUIRE(a.points.size() == b.points.size());
  for (std::size_t k = 0; k < a.points.size(); ++k) {
    CHECK(a.points[k].deviation * factor == b.points[k].deviation);
    CHECK(a.points[k].terms == b.points[k].terms);
  }
}

}  // namespace

TEST_CASE("pyramid equals the stride-m/4 reference to 2e-13, at every length around the block size") {
  for (const std::size_t n :
       {2UL,    3UL,    7UL,    8UL,    15UL,   16UL,   17UL,   63UL,   64UL,    1000UL,   4095UL,
        4096UL, 4097UL, 4102UL, 4103UL, 4104UL, 8191UL, 8192UL, 8193UL, 12288UL, 100003UL, 524288UL})
    check_against_direct(noise(n, unsigned(n)), 2e-13);
}

TEST_CASE("pyramid with offset and drift") {
  check_against_direct(noise(200000, 1, 987654321.123456), 2e-13);
  check_against_direct(noise(200000, 2, 9.81e3), 2e-13);
  check_against_direct(noise(200000, 3, 0, 1e6), 1e-10);
}

TEST_CASE("pyramid does not see how the samples were pushed") {
  auto y = noise(70001, 4, 100);
  for (const std::size_t gap : {0UL, 5UL, 4095UL, 4096UL, 40000UL, 40001UL, 70000UL}) y[gap] = std::nan("");
  const AllanCurve whole = pyramid_of(y);
  for (const std::size_t piece : {1UL, 2UL, 7UL, 67UL, 4095UL, 4096UL, 4097UL, 65537UL})
    check_same(whole, pyramid_of(y, piece));
}

TEST_CASE("pyramid takes means over what is present") {
  auto y = noise(50000, 5, 1000);
  std::mt19937_64 engine(6);
  check_against_direct(y, 2e-13);
  CHECK(pyramid_of(y).points.back().inflation == 1);
  y[0] = std::nan("");
  check_against_direct(y, 2e-13);
  y[20000] = std::numeric_limits<double>::infinity();
  y[20001] = -std::numeric_limits<double>::infinity();
  check_against_direct(y, 2e-13);
  CHECK(pyramid_of(y).missing == 3);
  CHECK(pyramid_of(y).points.back().m == 16384);
  CHECK(pyramid_of(y).notes.empty());  // what three samples add is not worth a word
  for (int i = 0; i < 500; ++i) y[engine() % y.size()] = std::nan("");
  check_against_direct(y, 2e-13);
  for (double& v : y)
    if (engine() % 10 == 0) v = std::nan("");
  check_against_direct(y, 1e-12);
  CHECK(pyramid_of(y).points.back().m == 16384);
  CHECK(pyramid_of(y).notes.size() == 1);
  std::fill(y.begin(), y.begin() + 9000, std::nan(""));
  std::fill(y.begin() + 30000, y.begin() + 34096, std::nan(""));
  check_against_direct(y, 1e-12);
}

TEST_CASE("pyramid scales bit-exactly by powers of two and survives extremes") {
  auto y = noise(20000, 7, 3);
  const AllanCurve base = pyramid_of(y);
  for (const int k : {-980, -600, -30, 1, 400, 900}) {
    auto scaled = y;
    for (double& v : scaled) v = std::ldexp(v, k);
    check_same(base, pyramid_of(scaled), std::ldexp(1.0, k));
  }
  // With samples missing where blocks meet as well: the means there have a scale of their own.
  auto holed = y;
  for (const std::size_t gap : {7UL, 4090UL, 4094UL, 4097UL, 8185UL, 8191UL, 16380UL}) holed[gap] = std::nan("");
  const AllanCurve with_gaps = pyramid_of(holed);
  for (const int k : {-600, 600, 900}) {
    auto scaled = holed;
    for (double& v : scaled) v = std::ldexp(v, k);
    check_same(with_gaps, pyramid_of(scaled), std::ldexp(1.0, k));
  }
  for (double& v : y) v *= 1e-310;
  const AllanCurve tiny = pyramid_of(y);
  for (std::size_t k = 0; k < base.points.size(); ++k)
    CHECK(tiny.points[k].deviation == Approx(base.points[k].deviation * 1e-310).epsilon(1e-5));
  std::vector<double> spike(20000, 1.0);
  spike[5000] = 1e300;
  CHECK(pyramid_of(spike).points[0].deviation == Approx(1e300 / std::sqrt(19999.0)).epsilon(1e-12));
  for (const double c : {0.0, 9.81, -1e9, 1e-310})
    for (const auto& p : pyramid_of(std::vector<double>(20000, c)).points) CHECK(p.deviation == 0);
}

TEST_CASE("pyramid counts what is missing at the end of a block of every level") {
  // One sample is missing, and the terms that reach across the end of its block are means of fewer:
  // at each level, its last places.
  for (const std::size_t gap : {4093UL, 8188UL, 8191UL, 16376UL, 16383UL, 32767UL}) {
    auto y = noise(40000, unsigned(gap), 5);
    y[gap] = std::nan("");
    INFO(gap);
    check_against_direct(y, 2e-13);
  }
}

TEST_CASE("pyramid and full overlap share m = 1, 2, 4 and agree within their spread above") {
  const auto y = noise(100000, 8);
  const AllanCurve pyramid = pyramid_of(y), full = allan_deviation(y, 0.5);
  REQUIRE(pyramid.points.size() == full.points.size());
  CHECK(pyramid.stride_divisor == 4);
  for (std::size_t k = 0; k < full.points.size(); ++k)
    CHECK(pyramid.points[k].deviation == Approx(full.points[k].deviation).epsilon(k < 3 ? 1e-13 : 0.1));
}

TEST_CASE("dense times at stride m/4 are the pyramid's at octaves and the direct sum elsewhere") {
  const auto y = noise(20000, 10, 1e6);
  AllanOptions options;
  options.grid = TauGrid::dense;
  options.stride_divisor = kPyramidStride;
  const AllanCurve dense = allan_deviation(y, 0.5, options), pyramid = pyramid_of(y);
  CHECK(dense.stride_divisor == kPyramidStride);
  std::size_t octaves = 0;
  for (const AllanPoint& p : dense.points) {
    CAPTURE(p.m);
    const std::uint64_t step = std::max<std::uint64_t>(1, p.m / 4);
    CHECK(p.terms == (y.size() - 2 * p.m) / step + 1);
    CHECK(stride_of(dense, p) == step);
    for (const AllanPoint& q : pyramid.points)
      if (q.m == p.m) {
        ++octaves;
        CHECK(p.deviation == Approx(q.deviation).epsilon(1e-12));
        CHECK(p.terms == q.terms);
      }
    if (p.m % 97 != 0) continue;
    long double sum = 0;
    std::uint64_t terms = 0;
    for (std::uint64_t i = 0; i + 2 * p.m <= y.size(); i += step, ++terms) {
      long double d = 0;
      for (std::uint64_t j = 0; j < p.m; ++j)
        d += static_cast<long double>(y[i + p.m + j]) - static_cast<long double>(y[i + j]);
      sum += d * d;
    }
    const long double m = static_cast<long double>(p.m);
    CHECK(p.deviation ==
          Approx(static_cast<double>(std::sqrt(sum / static_cast<long double>(2 * terms)) / m)).epsilon(1e-11));
  }
  CHECK(octaves == 10);  // above 1000 the dense ones are no powers of two
}

TEST_CASE("a stride is of overlapping terms between which nothing is missing") {
  auto y = noise(3000, 11);
  AllanOptions options;
  options.stride_divisor = kPyramidStride;
  for (const DeviationType type : {DeviationType::adev, DeviationType::totdev}) {
    options.type = type;
    CHECK(allan_deviation(y, 1, options).stride_divisor == 0);
  }
  options.type = DeviationType::mdev;
  CHECK(allan_deviation(y, 1, options).stride_divisor == kPyramidStride);
  y[100] = std::nan("");
  CHECK(allan_deviation(y, 1, options).stride_divisor == 0);
}

TEST_CASE("pyramid can be asked before the end and refuses too short records") {
  const auto y = noise(30000, 9);
  AllanPyramid pyramid;
  pyramid.push(std::span(y).first(10000));
  check_same(pyramid.finish(0.5), pyramid_of({y.begin(), y.begin() + 10000}));
  pyramid.push(std::span(y).subspan(10000));
  check_same(pyramid.finish(0.5), pyramid_of(y));
  CHECK_THROWS_AS(AllanPyramid().finish(1), Error);
  CHECK_THROWS_AS(pyramid_of({1.0}), Error);
  CHECK_THROWS_AS(pyramid_of({1.0, std::nan(""), 2.0}), Error);
  CHECK(pyramid_of({1.0, 2.0}).points.size() == 1);
}

TEST_CASE("pyramid: what stands behind a block is not looked at, what stands in it is") {
  // A page that may not be read stands behind the last value.
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  void* const pages = ::mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  REQUIRE(pages != MAP_FAILED);
  REQUIRE(::mprotect(static_cast<char*>(pages) + page, page, PROT_NONE) == 0);
  const std::span<double> whole(static_cast<double*>(pages), page / sizeof(double));
  for (std::size_t n = 1; n <= 24; ++n) {
    const std::span<double> z = whole.last(n);
    std::fill(z.begin(), z.end(), 1.0);
    double squares[3] = {}, pairs[12];
    INFO("n " << n);
    squares_of_one_two_four(z.data(), n, squares);
    sum_pairs(z.data(), n / 2, 1, pairs);
    CHECK(squares[0] + squares[1] + squares[2] + squares_of_four(z.data(), n) == 0);
    CHECK(all_finite(z.data(), n));
    for (std::size_t k = 0; k < n; ++k)
      for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        z[k] = bad;
        CHECK_FALSE(all_finite(z.data(), n));
        z[k] = 1;
      }
  }
  ::munmap(pages, 2 * page);
}
