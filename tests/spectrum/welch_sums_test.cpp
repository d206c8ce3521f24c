// Parts of a record joined against the stream: powers, degrees of freedom, segments that touch missing samples.

#include "libchar/spectrum/welch_sums.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "libchar/core/error.hpp"
#include "tests/support/parts.hpp"

using namespace libchar;

namespace {

std::vector<double> spectral_record(std::size_t n, double offset, bool holes) {
  std::mt19937_64 engine(n);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& x : y) x = offset + normal(engine);
  if (holes)
    for (std::size_t i = 1000; i < n; i += 7919) y[i] = std::nan("");
  return y;
}

void check_spectrum(const WelchOptions& options, const std::vector<double>& y, std::size_t leaf,
                    double digits = 1e-11) {
  CAPTURE(options.segment, options.overlap, y.size(), leaf);
  REQUIRE(WelchParts::why_not(options, leaf) == "");
  WelchStream stream(options);
  stream.push(y);
  const Spectrum whole = stream.finish(100);
  WelchParts parts(options);
  const WelchSums sums = test::joined_parts<WelchSums>(
      y, leaf, [&](std::span<const double> part, bool) { return parts.take(part); },
      [&](WelchSums& before, const WelchSums& later) { parts.join(before, later); });
  const Spectrum joined = WelchStream(options, sums).finish(100);
  REQUIRE(joined.segments == whole.segments);
  REQUIRE(joined.dropped == whole.dropped);
  REQUIRE(joined.notes == whole.notes);
  REQUIRE(joined.value.size() == whole.value.size());
  for (std::size_t k = 1; k < whole.value.size(); ++k) {
    REQUIRE(joined.value[k] == Approx(whole.value[k]).epsilon(digits));
    REQUIRE(joined.dof[k] == Approx(whole.dof[k]).epsilon(1e-12));
  }
}

}  // namespace

TEST_CASE("Welch sums: parts are the stream, by segments and by halves") {
  for (const bool holes : {false, true})
    for (const std::size_t n : {32768u, 50000u, 65535u, 3 * 16384u + 1}) {
      const std::vector<double> y = spectral_record(n, 3, holes);
      for (const double overlap : {0.0, 0.5, 0.75}) check_spectrum({.segment = 512, .overlap = overlap}, y, 1024);
      check_spectrum({.window = Window::blackman_harris, .segment = 1024, .overlap = 0.875}, y, 1024);
      check_spectrum({.segment = 4096}, y, 16384);
      check_spectrum({.segment = 4096, .detrend = Detrend::linear}, y, 4096);
    }
}

// The stream takes the mean of each half, whose rounding is 1e-7 of the noise here; a straddling segment has one mean.
TEST_CASE("Welch sums: an offset of 1e9 standard deviations costs what it costs the stream") {
  check_spectrum({.segment = 4096}, spectral_record(60000, 1e9, false), 16384, 1e-7);
  check_spectrum({.segment = 512}, spectral_record(60000, 1e9, false), 16384);
}

TEST_CASE("Welch sums: segments that do not divide a part are refused in a sentence") {
  REQUIRE(WelchParts::why_not({.segment = 1000}, 4096) ==
          "segments begin every 500 samples, which do not divide a leaf of 4096");
  REQUIRE(WelchParts::why_not({.segment = 8192}, 4096) == "segments of 8192 samples are longer than a leaf of 4096");
}

TEST_CASE("Welch sums: a state that no part of a record has is refused") {
  const WelchParts parts({.segment = 16});
  const std::vector<double> y = spectral_record(100, 0, false);
  const auto read = [&](const WelchSums& sums) {
    StateWriter to("spectrum", 1);
    WelchParts::write_state(sums, to);
    const std::string bytes = to.finish();
    StateReader from(bytes, "x", "spectrum", 1);
    return parts.read_state(from);
  };
  const auto refused = [&](auto change) {
    WelchSums odd = parts.take(y);
    change(odd);
    REQUIRE_THROWS_AS(read(odd), Error);
  };
  REQUIRE(read(parts.take(y)).used == 11);
  REQUIRE(read({}).samples == 0);
  refused([](WelchSums& sums) { sums = {}, sums.used = 5; });
  refused([](WelchSums& sums) { sums.used = 1000000; });
  refused([](WelchSums& sums) { ++sums.dropped; });
  refused([](WelchSums& sums) { sums.pairs[1] = std::uint64_t{1} << 60U; });
  refused([](WelchSums& sums) { sums.head.pop_back(); });
  refused([](WelchSums& sums) { sums.end.clear(); });
}
