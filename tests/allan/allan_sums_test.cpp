// Parts of a record joined against the stream: values, counts, missing samples, offsets, lengths of the last part.

#include "libchar/allan/allan_sums.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/core/error.hpp"
#include "tests/support/parts.hpp"

using namespace libchar;

namespace {

std::vector<double> record_of_parts(std::size_t n, double offset, double drift, double missing) {
  std::mt19937_64 engine(n);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> chance;
  std::vector<double> y(n);
  double walk = 0;
  for (std::size_t i = 0; i < n; ++i) {
    walk += 0.01 * normal(engine);
    y[i] = offset + normal(engine) + walk + drift * static_cast<double>(i);
    if (chance(engine) < missing) y[i] = std::nan("");
  }
  return y;
}

AllanSums sums_in_parts(const std::vector<double>& y, std::size_t leaf) {
  return test::joined_parts<AllanSums>(
      y, leaf,
      [](std::span<const double> part, bool) {
        AllanPyramid pyramid;
        pyramid.push(part);
        return std::move(pyramid).sums();
      },
      [](AllanSums& sums, const AllanSums& later) { join(sums, later); });
}

void check_parts(const std::vector<double>& y, std::size_t leaf, double digits) {
  CAPTURE(y.size(), leaf);
  const AllanCurve whole = pyramid_deviation(y, 0.5);
  const AllanSums sums = sums_in_parts(y, leaf);
  const AllanCurve joined = octave_curve(sums, 0.5);
  REQUIRE(joined.samples == whole.samples);
  REQUIRE(joined.missing == whole.missing);
  REQUIRE(joined.points.size() == whole.points.size());
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    CAPTURE(whole.points[i].m);
    REQUIRE(joined.points[i].m == whole.points[i].m);
    REQUIRE(joined.points[i].terms == whole.points[i].terms);
    REQUIRE(joined.points[i].deviation == Approx(whole.points[i].deviation).epsilon(digits));
    REQUIRE(joined.points[i].inflation == Approx(whole.points[i].inflation).epsilon(1e-9));
  }
}

}  // namespace

TEST_CASE("Allan sums: parts are the stream, whatever their length and that of the last") {
  for (const std::size_t leaf : {2u, 8u, 256u, 4096u, 16384u})
    for (const std::size_t n : {1u, 2u, 3u, 7u, 255u, 4097u, 40000u, 65536u, 65537u})
      if (n > 1 && n / leaf < 9000) check_parts(record_of_parts(n, 0.3, 0, 0), leaf, 1e-12);
}

TEST_CASE("Allan sums: an offset of 1e9 standard deviations and a drift cost nothing") {
  for (const std::size_t leaf : {64u, 8192u}) {
    check_parts(record_of_parts(100001, 1e9, 0, 0), leaf, 1e-12);
    check_parts(record_of_parts(100001, 1e9, 0.01, 0), leaf, 1e-12);
  }
}

TEST_CASE("Allan sums: missing samples, at boundaries too, and parts without any") {
  for (const std::size_t leaf : {64u, 8192u}) {
    check_parts(record_of_parts(100001, 5, 0, 0.1), leaf, 1e-11);
    std::vector<double> y = record_of_parts(70000, 5, 0, 0.001);
    for (std::size_t i = 0; i < leaf + 5; ++i) y[i] = std::nan("");
    for (std::size_t i = 4 * leaf - 3; i < 5 * leaf + 2; ++i) y[i] = std::nan("");
    check_parts(y, leaf, 1e-11);
  }
}

TEST_CASE("Allan sums: a state that was written and read is the same") {
  const AllanSums sums = sums_in_parts(record_of_parts(5000, 1, 0, 0.01), 1024);
  StateWriter to("allan", 1);
  write_state(sums, to);
  const std::string bytes = to.finish();
  StateReader from(bytes, "x", "allan", 1);
  const AllanCurve a = octave_curve(sums, 1), b = octave_curve(read_allan_sums(from), 1);
  from.finish();
  REQUIRE(a.points.size() == b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) REQUIRE(a.points[i].deviation == b.points[i].deviation);
}

TEST_CASE("Allan sums: a state with more terms than its samples have is refused") {
  const AllanSums sums = sums_in_parts(record_of_parts(16, 1, 0, 0), 16);
  const auto refused = [&](auto change) {
    AllanSums odd = sums;
    change(odd.levels[0].terms[0]);
    StateWriter to("allan", 1);
    write_state(odd, to);
    const std::string bytes = to.finish();
    StateReader from(bytes, "x", "allan", 1);
    REQUIRE_THROWS_AS(read_allan_sums(from), Error);
  };
  refused([](PresentTerms& terms) { terms.terms = terms.starts = 16; });  // 15 fit
  refused([](PresentTerms& terms) { terms.terms = terms.starts = std::uint64_t{1} << 60U; });
  refused([](PresentTerms& terms) { terms.starts = 0; });
}

TEST_CASE("Allan sums: a part that would straddle is refused") {
  const std::vector<double> y = record_of_parts(100, 0, 0, 0);
  AllanSums sums = sums_in_parts({y.begin(), y.begin() + 3}, 4);
  REQUIRE_THROWS_AS(join(sums, sums_in_parts(y, 128)), std::logic_error);
}
