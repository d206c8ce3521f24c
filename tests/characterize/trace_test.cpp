#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/characterize/characterization.hpp"
#include "tests/support/parts.hpp"

using namespace libchar;

namespace {

std::vector<double> noise(std::size_t n) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<double> out(n);
  for (double& x : out) x = normal(random);
  return out;
}

Trace trace_in_pieces(const std::vector<double>& x, std::size_t piece) {
  TraceMeter meter;
  for (std::size_t i = 0; i < x.size(); i += piece) meter.push({x.data() + i, std::min(piece, x.size() - i)});
  return meter.finish();
}

}  // namespace

TEST_CASE("trace: extremes of each block, whatever the pieces, in a few hundred blocks") {
  for (const std::size_t n : {1u, 5u, 799u, 800u, 801u, 100003u}) {
    std::vector<double> x = noise(n);
    if (n > 1000) {
      x[n - 2] = 99;
      std::fill(x.begin() + 2000, x.begin() + 5000, std::numeric_limits<double>::quiet_NaN());
    }
    const Trace trace = trace_in_pieces(x, n);
    CAPTURE(n);
    CHECK(trace.low.size() <= 800);
    CHECK(trace.low.size() == (n + trace.block - 1) / trace.block);
    std::size_t wrong = 0;
    for (std::size_t b = 0; b < trace.low.size(); ++b) {
      double low = INFINITY, high = -INFINITY;
      std::uint64_t missing = 0;
      for (std::size_t i = b * trace.block; i < std::min<std::size_t>(n, (b + 1) * trace.block); ++i) {
        if (std::isnan(x[i])) ++missing;
        if (x[i] < low) low = x[i];
        if (x[i] > high) high = x[i];
      }
      const bool any = low <= high;
      wrong += missing != trace.missing[b] ? 1 : 0;
      wrong += any ? (low != trace.low[b] || high != trace.high[b] ? 1 : 0)
                   : (std::isnan(trace.low[b]) && std::isnan(trace.high[b]) ? 0 : 1);
    }
    CHECK(wrong == 0);
    for (const std::size_t piece : {1u, 7u, 4096u}) {
      const Trace other = trace_in_pieces(x, piece);
      CHECK(other.block == trace.block);
      CHECK(std::equal(other.missing.begin(), other.missing.end(), trace.missing.begin(), trace.missing.end()));
      CHECK(std::equal(other.high.begin(), other.high.end(), trace.high.begin(), trace.high.end(),
                       [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
    }
  }
}

TEST_CASE("trace: parts joined are the record, whatever their length and that of the last") {
  for (const std::size_t leaf : {16u, 2048u, 16384u})
    for (const std::size_t n : {5u, 2048u, 2049u, 100003u, 16384u * 7 + 1}) {
      std::vector<double> x = noise(n);
      if (n > 6000) std::fill(x.begin() + 2000, x.begin() + 5000, std::numeric_limits<double>::quiet_NaN());
      const TraceMeter joined = test::joined_parts<TraceMeter>(
          x, leaf,
          [](std::span<const double> part, bool) {
            TraceMeter meter;
            meter.push(part);
            return meter;
          },
          [](TraceMeter& before, const TraceMeter& later) { before.join(later); });
      const Trace a = trace_in_pieces(x, n), b = joined.finish();
      CAPTURE(leaf, n);
      REQUIRE(a.block == b.block);
      REQUIRE(a.missing == b.missing);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < a.low.size(); ++i)
        if (std::isnan(a.low[i]) ? !std::isnan(b.low[i]) : a.low[i] != b.low[i] || a.high[i] != b.high[i]) ++wrong;
      REQUIRE(wrong == 0);
    }
}
