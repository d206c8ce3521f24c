#include "libchar/spectrum/welch.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>

#include "libchar/core/error.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch_sums.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

std::vector<double> white_samples(std::size_t n, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = normal(generator);
  return y;
}

WelchOptions welch_segments(std::uint64_t n) {
  WelchOptions options;
  options.segment = n;
  return options;
}

std::vector<std::vector<double>> columns(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  std::vector<std::vector<double>> out;
  while (std::getline(in, line)) {
    std::stringstream cells(line);
    std::string cell;
    for (std::size_t c = 0; std::getline(cells, cell, ','); ++c) {
      if (out.size() <= c) out.emplace_back();
      out[c].push_back(std::stod(cell));
    }
  }
  return out;
}

// The definition, term by term.
std::vector<double> slow_welch(const std::vector<double>& x, double rate, std::size_t n, std::size_t hop, Window kind,
                               bool centred) {
  const auto w = window_values(kind, n);
  double energy = 0;
  for (const double v : w) energy += v * v;
  std::vector<double> power(n / 2 + 1, 0.0);
  int count = 0;
  for (std::size_t begin = 0; begin + n <= x.size(); begin += hop, ++count) {
    double mean = 0;
    if (centred)
      for (std::size_t t = 0; t < n; ++t) mean += x[begin + t] / static_cast<double>(n);
    for (std::size_t k = 0; k <= n / 2; ++k) {
      std::complex<double> sum = 0;
      for (std::size_t t = 0; t < n; ++t)
        sum += w[t] * (x[begin + t] - mean) *
               std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k * t % n) / static_cast<double>(n));
      power[k] += std::norm(sum) / (rate * energy) * (k == 0 || 2 * k == n ? 1 : 2);
    }
  }
  for (double& p : power) p /= count;
  return power;
}

}  // namespace

TEST_CASE("Welch's spectrum of the known vector, in 50 digits, is met to double precision") {
  const auto input = columns(test::known("fusion/psd_input.csv"));
  const auto wanted = columns(test::known("fusion/psd_welch.csv"));
  WelchOptions options = welch_segments(512);
  options.window = Window::hann_nonzero;
  options.detrend = Detrend::none;
  const Spectrum got = welch(input[1], 100, options);
  CHECK(got.segments == 7);
  REQUIRE(got.value.size() == 257);
  for (std::size_t k = 0; k < 257; ++k) {
    CAPTURE(k);
    CHECK(got.frequency_hz[k] == Approx(wanted[1][k]).epsilon(1e-15));
    CHECK(std::abs(got.value[k] / wanted[2][k] - 1) < 1e-12);
  }
}

TEST_CASE("Welch's spectrum is its definition, for odd, prime and even segments and any hop") {
  const auto x = white_samples(700, 1);
  for (const std::size_t n : {8U, 9U, 64U, 97U, 150U, 311U, 700U})
    for (const double overlap : {0.0, 0.3, 0.5, 0.9}) {
      CAPTURE(n, overlap);
      WelchOptions options = welch_segments(n);
      options.overlap = overlap;
      const auto hop =
          std::max<std::size_t>(1, static_cast<std::size_t>(std::round(static_cast<double>(n) * (1 - overlap))));
      const Spectrum got = welch(x, 7, options);
      const auto wanted = slow_welch(x, 7, n, hop, Window::hann, true);
      REQUIRE(got.value.size() == wanted.size());
      for (std::size_t k = 0; k < wanted.size(); ++k)
        REQUIRE(got.value[k] == Approx(wanted[k]).epsilon(1e-11).margin(1e-14));
    }
}

TEST_CASE("the sum of the spectrum is the mean square (rectangular, no overlap), one- and two-sided, even and odd") {
  for (const std::size_t n : {50U, 51U}) {
    const auto x = white_samples(n * 20, 2);
    double square = 0;
    for (const double v : x) square += v * v / static_cast<double>(x.size());
    WelchOptions options = welch_segments(n);
    options.window = Window::rectangular;
    options.overlap = 0;
    options.detrend = Detrend::none;
    for (const Sides sides : {Sides::one, Sides::two}) {
      options.sides = sides;
      const Spectrum s = welch(x, 12.5, options);
      double sum = 0;
      for (const double v : s.value) sum += v * 12.5 / static_cast<double>(n);
      CHECK(std::abs(sum / square - 1) < 1e-13);
    }
  }
}

TEST_CASE("two-sided frequencies run from above -Nyquist to +Nyquist and hold half the one-sided density") {
  const auto x = white_samples(4000, 3);
  for (const std::size_t n : {64U, 65U}) {
    WelchOptions options = welch_segments(n);
    const Spectrum one = welch(x, 100, options);
    options.sides = Sides::two;
    const Spectrum two = welch(x, 100, options);
    REQUIRE(two.value.size() == n);
    CHECK(std::is_sorted(two.frequency_hz.begin(), two.frequency_hz.end()));
    if (n == 64) CHECK(two.frequency_hz.back() == 50);
    CHECK(two.frequency_hz.front() > -50);
    const std::size_t zero = (n - 1) / 2;
    CHECK(two.frequency_hz[zero] == 0);
    for (std::size_t k = 0; k < one.value.size(); ++k) {
      const bool edge = k == 0 || 2 * k == n;
      CHECK(two.value[zero + k] == one.value[k] / (edge ? 1 : 2));
      CHECK(two.dof[zero + k] == one.dof[k]);
      if (k > 0 && !edge) CHECK(two.value[zero - k] == two.value[zero + k]);
    }
  }
}

TEST_CASE("a sine on a bin reads its amplitude in every scaling, window and sidedness") {
  const std::size_t n = 1024;
  const double rate = 200, amplitude = 3;
  std::vector<double> x(8 * n);
  for (std::size_t t = 0; t < x.size(); ++t)
    x[t] = amplitude * std::sin(2 * std::numbers::pi * 100 * static_cast<double>(t % n) / static_cast<double>(n));
  for (const Window window : {Window::hann, Window::rectangular, Window::blackman_harris, Window::flat_top}) {
    CAPTURE(name_of(window));
    WelchOptions options = welch_segments(n);
    options.window = window;
    const auto peak = [&](Scaling scaling) {
      options.scaling = scaling;
      return welch(x, rate, options).value[100];
    };
    const double enbw = welch(x, rate, options).enbw_hz;
    CHECK(peak(Scaling::ps) == Approx(amplitude * amplitude / 2).epsilon(1e-12));
    CHECK(peak(Scaling::ls) == Approx(amplitude / std::sqrt(2)).epsilon(1e-12));
    CHECK(peak(Scaling::psd) == Approx(amplitude * amplitude / (2 * enbw)).epsilon(1e-12));
    CHECK(peak(Scaling::lsd) == Approx(amplitude / std::sqrt(2 * enbw)).epsilon(1e-12));
  }
}

TEST_CASE("equivalent noise bandwidths are those of the literature") {
  const auto bins = [](Window window) {
    WelchOptions options = welch_segments(4096);
    options.window = window;
    return welch(white_samples(4096, 1), 4096, options).enbw_hz;
  };
  CHECK(bins(Window::rectangular) == Approx(1).epsilon(1e-14));
  CHECK(bins(Window::hann) == Approx(1.5).epsilon(1e-14));
  CHECK(bins(Window::blackman_harris) == Approx(2.0044).epsilon(1e-4));  // Heinzel, Ruediger and Schilling 2002
  CHECK(bins(Window::flat_top) == Approx(3.7702).epsilon(1e-4));
}

TEST_CASE("windows are named, symmetric and read back") {
  for (const Window window :
       {Window::hann, Window::rectangular, Window::blackman_harris, Window::flat_top, Window::hann_nonzero}) {
    CHECK(find_enum<Window>(name_of(window)) == window);
    for (const std::size_t n : {9U, 16U}) {
      const auto w = window_values(window, n);
      const bool periodic = window != Window::hann_nonzero;
      for (std::size_t j = 1; j < n; ++j) CHECK(w[j] == w[periodic ? n - j : n - 1 - j]);
    }
  }
  CHECK_FALSE(find_enum<Window>("hanning").has_value());
  CHECK(window_values(Window::hann, 2) == std::vector<double>{0, 1});
  CHECK(window_values(Window::hann, 4)[1] == Approx(0.5).epsilon(1e-15));
}

TEST_CASE("invariants: scale by powers of two, offset, reversal, shift, zero") {
  const auto x = white_samples(6000, 4);
  const WelchOptions options = welch_segments(500);
  const Spectrum base = welch(x, 100, options);

  auto scaled = x;
  for (double& v : scaled) v *= 1024;
  const Spectrum big = welch(scaled, 100, options);
  for (std::size_t k = 0; k < base.value.size(); ++k) REQUIRE(big.value[k] == base.value[k] * 1024 * 1024);

  auto offset = x;
  for (double& v : offset) v += 1e9;
  auto rounded = offset;
  for (double& v : rounded) v -= 1e9;
  const Spectrum low = welch(rounded, 100, options), high = welch(offset, 100, options);
  for (std::size_t k = 1; k < base.value.size(); ++k) REQUIRE(std::abs(high.value[k] / low.value[k] - 1) < 1e-10);

  auto reversed = x;
  std::reverse(reversed.begin(), reversed.end());
  WelchOptions boxcar = options;
  boxcar.window = Window::rectangular;
  const Spectrum forth = welch(x, 100, boxcar), back = welch(reversed, 100, boxcar);
  for (std::size_t k = 1; k < forth.value.size(); ++k) REQUIRE(std::abs(back.value[k] / forth.value[k] - 1) < 1e-12);

  const std::vector<double> one(x.begin(), x.begin() + 500);
  auto turned = one;
  std::rotate(turned.begin(), turned.begin() + 123, turned.end());
  const Spectrum still = welch(one, 100, boxcar), shifted = welch(turned, 100, boxcar);
  for (std::size_t k = 1; k < still.value.size(); ++k) REQUIRE(std::abs(shifted.value[k] / still.value[k] - 1) < 1e-11);

  for (const double v : welch(std::vector<double>(1000, 0.0), 1, options).value) REQUIRE(v == 0);
  for (const double v : welch(std::vector<double>(1000, 0.1), 1, options).value) REQUIRE(v < 1e-30);
}

TEST_CASE("linear detrending removes a line, and leaves the noise") {
  const auto x = white_samples(1U << 16U, 5);
  auto drifting = x;
  for (std::size_t t = 0; t < x.size(); ++t) drifting[t] += 1e4 + 3.7 * static_cast<double>(t);
  WelchOptions options = welch_segments(1024);
  options.detrend = Detrend::linear;
  const Spectrum without = welch(x, 1, options), with = welch(drifting, 1, options);
  for (std::size_t k = 1; k < with.value.size(); ++k) REQUIRE(std::abs(with.value[k] / without.value[k] - 1) < 1e-7);
  options.detrend = Detrend::constant;
  CHECK(welch(drifting, 1, options).value[1] > 1e3 * without.value[1]);
}

TEST_CASE("white noise has the density 2 sigma^2 / rate, and its scatter is the stated degrees of freedom") {
  for (const double overlap : {0.0, 0.5, 0.75}) {
    for (const Window window : {Window::hann, Window::rectangular, Window::blackman_harris}) {
      CAPTURE(overlap, name_of(window));
      WelchOptions options = welch_segments(64);
      options.window = window;
      options.overlap = overlap;
      options.detrend = Detrend::none;
      double sum = 0, squares = 0, edge_sum = 0, edge_squares = 0, dof = 0, edge_dof = 0;
      const int records = 4000;
      for (int i = 0; i < records; ++i) {
        const Spectrum s = welch(white_samples(320, static_cast<unsigned>(i)), 10, options);
        sum += s.value[16];
        squares += s.value[16] * s.value[16];
        edge_sum += s.value[32];
        edge_squares += s.value[32] * s.value[32];
        dof = s.dof[16];
        edge_dof = s.dof[32];
      }
      const double mean = sum / records, variance = squares / records - mean * mean;
      const double edge_mean = edge_sum / records, edge_variance = edge_squares / records - edge_mean * edge_mean;
      CHECK(mean == Approx(0.2).epsilon(0.04));
      CHECK(edge_mean == Approx(0.1).epsilon(0.05));  // no doubling at Nyquist
      CHECK(2 * mean * mean / variance == Approx(dof).epsilon(0.12));
      CHECK(2 * edge_mean * edge_mean / edge_variance == Approx(edge_dof).epsilon(0.15));
      CHECK(edge_dof == dof / 2);
    }
  }
}

TEST_CASE("degrees of freedom: 2 a segment without overlap, Hann at half overlap as in the books") {
  WelchOptions options = welch_segments(256);
  options.overlap = 0;
  CHECK(welch(white_samples(2560, 1), 1, options).dof[5] == Approx(20).epsilon(1e-14));
  options.overlap = 0.5;
  const Spectrum s = welch(white_samples(25600, 1), 1, options);
  CHECK(s.segments == 199);
  CHECK(s.dof[5] == Approx(2 * 199 / (1 + 2 * (1.0 - 1.0 / 199) / 36)).epsilon(1e-12));  // r_1 = 1/6 for Hann
  REQUIRE(s.neighbour_correlation.size() >= 2);
  CHECK(s.neighbour_correlation[0] == Approx(0.44).margin(0.02));  // (2/3)^2 for one segment
  options.overlap = 0.99;  // many lags: by transform; the limit of dense overlap for Hann is 1/0.52
                           // times that of half overlap's 1/0.528
  CHECK(welch(white_samples(25600, 1), 1, options).dof[5] == Approx(s.dof[5]).epsilon(0.12));
}

TEST_CASE("intervals cover at the stated rate and match chi-square tables") {
  CHECK(interval_factors(10, 0.95).first == Approx(10 / 20.4831773508).epsilon(1e-10));
  CHECK(interval_factors(10, 0.95).second == Approx(10 / 3.2469727802).epsilon(1e-10));
  CHECK(std::isinf(interval_factors(0, 0.95).second));
  // Cornish & Fisher's expansion in 60 digits.
  CHECK(interval_factors(1e8, 0.95).first == Approx(0.99972287711094144).epsilon(1e-15));
  CHECK(interval_factors(1e11, 0.95).first == Approx(0.99999123483248003).epsilon(1e-15));
  CHECK(interval_factors(1e11, 0.95).second == Approx(1.00000876528329220).epsilon(1e-15));
  CHECK(interval_factors(1e13, 0.95).second == Approx(1.00000087652311944).epsilon(1e-15));
  const Spectrum s = welch(white_samples(1U << 18U, 6), 2, welch_segments(4096));
  int inside = 0, count = 0;
  for (std::size_t k = 2; k < 2048; k += 3, ++count) {
    const auto [low, high] = IntervalFactors(0.95).interval(s, k);
    inside += low <= 1 && 1 <= high;
  }
  CHECK(inside == Approx(0.95 * count).margin(4 * std::sqrt(0.0475 * count)));
  Spectrum root = s;
  root.scaling = Scaling::lsd;
  root.value[7] = std::sqrt(s.value[7]);
  CHECK(IntervalFactors(0.95).interval(root, 7).first == Approx(std::sqrt(IntervalFactors(0.95).interval(s, 7).first)));
}

TEST_CASE("threads change no bit") {
  const auto x = white_samples(1U << 19U, 7);
  for (const std::uint64_t n : {16U, 1000U, 4096U, 65536U}) {
    WelchOptions options = welch_segments(n);
    options.threads = 1;
    const Spectrum single = welch(x, 1, options);
    for (const int threads : {0, 2, 3, 8}) {
      options.threads = threads;
      CHECK(welch(x, 1, options).value == single.value);
    }
  }
}

TEST_CASE("a stream gives the bits of the whole, however it is pushed, with missing samples too") {
  auto x = white_samples(20011, 8);
  for (const bool dirty : {false, true}) {
    if (dirty) x[0] = x[7003] = x[7004] = x[20010] = kAbsent;
    for (const std::uint64_t n : {8U, 100U, 1024U, 5003U}) {
      for (const double overlap : {0.0, 0.5, 0.8}) {
        WelchOptions options = welch_segments(n);
        options.overlap = overlap;
        options.detrend = Detrend::linear;
        const Spectrum whole = welch(x, 50, options);
        for (const std::size_t block : {1U, 7U, 64U, 999U, 4096U, 20011U}) {
          WelchStream stream(options);
          for (std::size_t i = 0; i < x.size(); i += block) stream.push({x.data() + i, std::min(block, x.size() - i)});
          const Spectrum s = stream.finish(50);
          CAPTURE(n, overlap, block, dirty);
          REQUIRE(s.value == whole.value);
          REQUIRE(s.dof == whole.dof);
          REQUIRE(s.segments == whole.segments);
          REQUIRE(s.dropped == whole.dropped);
          REQUIRE(s.notes == whole.notes);
        }
      }
    }
  }
}

TEST_CASE("a stream of one segment, or of one more than a group of 32, counts the last") {
  constexpr std::size_t kSegment = 2048;
  const auto x = white_samples(65 * kSegment, 12);
  WelchOptions options = welch_segments(kSegment);
  options.overlap = 0;
  std::vector<double> sum(kSegment / 2 + 1);
  for (std::size_t s = 0; s < 65; ++s) {
    WelchStream alone(options), all(options);
    alone.push(std::span(x).subspan(s * kSegment, kSegment));
    const Spectrum one = alone.finish(1);
    REQUIRE(one.segments == 1);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += one.value[k];
    if (s != 0 && s != 1 && s != 31 && s != 32 && s != 64) continue;
    all.push(std::span(x).first((s + 1) * kSegment));
    const Spectrum mean = all.finish(1);
    CAPTURE(s);
    REQUIRE(mean.segments == s + 1);
    for (std::size_t k = 1; k < sum.size(); ++k) {
      REQUIRE(sum[k] > 0);
      REQUIRE(mean.value[k] == Approx(sum[k] / static_cast<double>(s + 1)).epsilon(1e-12));
    }
  }
}

TEST_CASE("segments that touch a missing sample are dropped and counted, and the rest is untouched") {
  auto x = white_samples(1000, 9);
  x[250] = kAbsent;
  WelchOptions options = welch_segments(100);
  const Spectrum s = welch(x, 1, options);
  CHECK(s.segments == 17);
  CHECK(s.dropped == 2);
  CHECK(s.notes.size() == 1);
  for (const double v : s.value) REQUIRE(std::isfinite(v));
  options.overlap = 0;
  const Spectrum apart = welch(x, 1, options);
  std::vector<double> kept(x.begin(), x.begin() + 200);
  kept.insert(kept.end(), x.begin() + 300, x.end());
  const Spectrum wanted = welch(kept, 1, options);
  for (std::size_t k = 0; k < wanted.value.size(); ++k) CHECK(apart.value[k] == Approx(wanted.value[k]).epsilon(1e-14));
  CHECK(apart.dof == wanted.dof);
}

TEST_CASE("the default segment is a quarter of the record, shorter where samples are missing, with a note") {
  CHECK(welch(white_samples(1003, 1), 1).segment == 250);
  CHECK(welch(white_samples(10, 1), 1).segment == 8);
  auto x = white_samples(4000, 10);
  for (std::size_t i = 37; i < x.size(); i += 400) x[i] = kAbsent;
  const Spectrum s = welch(x, 1);
  CHECK(s.segment == 250);
  CHECK(s.segments >= 7);
  CHECK(s.notes.size() == 2);

  const Spectrum shorter = welch(white_samples(100, 1), 1, welch_segments(1000));
  CHECK(shorter.segment == 100);
  CHECK(shorter.notes.size() == 1);
}

TEST_CASE("what cannot be done is refused with what is needed") {
  const auto message = [](auto&& run) -> std::string {
    try {
      run();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  CHECK(message([] { welch({}, 1); }).find("at least 8 consecutive samples") != std::string::npos);
  CHECK(message([] { welch(std::vector<double>(7, 1.0), 1); }).find("has 7") != std::string::npos);
  CHECK(message([] { welch(std::vector<double>(100, kAbsent), 1); }).find("has 0") != std::string::npos);
  CHECK_THROWS_AS(welch(white_samples(100, 1), 0), Error);
  CHECK_THROWS_AS(welch(white_samples(100, 1), kAbsent), Error);
  WelchOptions options = welch_segments(4);
  CHECK_THROWS_AS(welch(white_samples(100, 1), 1, options), Error);
  options = welch_segments(16);
  options.overlap = 1;
  CHECK_THROWS_AS(welch(white_samples(100, 1), 1, options), Error);
  options.overlap = kAbsent;
  CHECK_THROWS_AS(WelchStream(options), Error);
  CHECK_THROWS_AS(WelchStream(WelchOptions{}), Error);
  WelchStream stream(welch_segments(16));
  stream.push(white_samples(15, 1));
  CHECK(message([&] { stream.finish(1); }).find("segments of 16 samples") != std::string::npos);
}

TEST_CASE("infinite samples are missing samples") {
  auto x = white_samples(1000, 9);
  x[250] = std::numeric_limits<double>::infinity();
  const Spectrum s = welch(x, 1, welch_segments(100));
  CHECK(s.dropped == 2);
  for (const double v : s.value) REQUIRE(std::isfinite(v));
}

TEST_CASE("welch: squares that a double does not hold are refused, in memory and streamed") {
  std::vector<double> plain(4096);
  for (std::size_t i = 0; i < plain.size(); ++i) plain[i] = std::sin(static_cast<double>(i) * static_cast<double>(i));
  WelchOptions options;
  options.segment = 256;
  const auto streamed = [&](const std::vector<double>& y) {
    WelchStream stream(options);
    stream.push(y);
    return stream.finish(1);
  };
  for (const double factor : {1e200, 1e-200, 1e-310}) {
    INFO(factor);
    std::vector<double> y = plain;
    for (double& v : y) v *= factor;
    CHECK_THROWS_WITH(welch(y, 1, options), Catch::Contains("E0420"));
    CHECK_THROWS_WITH(streamed(y), Catch::Contains("E0420"));
  }
  // A record that does not move has no power, and one whose only move is in no segment neither.
  std::vector<double> still(4100, 9.81);
  CHECK(welch(still, 1, options).value[3] == 0);
  still.back() = 10;
  CHECK(welch(still, 1, options).value[3] == 0);
  CHECK(streamed(still).value[3] == 0);
}
