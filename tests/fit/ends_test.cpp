// The two ends of phase noise: random numbers that all slow coefficients share.
#include "libchar/fit/detail/record/ends.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/record/record_sums.hpp"
#include "libchar/spectrum/fft.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

/// Differences of white phase noise of deviation 1, and white frequency noise whose Allan deviation meets its own at
/// `crossing` samples; 0: none.
std::vector<double> frequency(std::uint64_t seed, std::size_t n, double crossing) {
  test::Gaussian normal(seed);
  const double white = crossing > 0 ? std::sqrt(3 / crossing) : 0;
  std::vector<double> y(n);
  double before = normal();
  for (double& value : y) {
    const double now = normal();
    value = now - before + (white > 0 ? white * normal() : 0);
    before = now;
  }
  return y;
}

NoiseFit fit_at_ends(const std::vector<double>& y, bool clock) {
  FitOptions options;
  options.clock = clock;
  options.second_opinion = false;
  return fit_record(y, 1, nullptr, options);
}

const Coefficient& of(const NoiseFit& fit, Term term) { return fit.term[static_cast<std::size_t>(term)]; }

}  // namespace

TEST_CASE("ends: without them the coefficients of differences are independent") {
  // The exact projection: what is left of a record is the same whatever its two end samples are.
  const std::vector<double> y = frequency(3, 512, 0);
  std::vector<double> other = y;
  other.front() += 5;
  other.back() -= 3;
  const detail::EndNoise noise{{0, 0, 0, 1, 0}, 1};
  Dct dct(y.size());
  const auto left = [&](const std::vector<double>& record) {
    const auto c = dct.transform(record);
    std::vector<double> out(c.begin(), c.end());
    detail::take_out_ends(out, noise);
    return out;
  };
  const std::vector<double> a = left(y), b = left(other);
  for (std::size_t k = 1; k < a.size(); ++k) CHECK(a[k] == Approx(b[k]).margin(1e-9));
}

TEST_CASE("ends: the share that goes with them is that of many records") {
  constexpr std::size_t kRecords = 4000, kSamples = 256;
  const detail::EndNoise noise{{0, 0, 0, 1, 0}, 1};
  std::vector<double> power(kSamples), share;
  Dct dct(kSamples);
  for (std::size_t i = 0; i < kRecords; ++i) {
    const auto c = dct.transform(frequency(100 + i, kSamples, 0));
    std::vector<double> left(c.begin(), c.end());
    share = detail::take_out_ends(left, noise);
    for (std::size_t k = 1; k < kSamples; ++k) power[k] += left[k] * left[k] / kRecords;
  }
  for (const std::size_t k : {1U, 2U, 3U, 4U, 10U, 100U}) {
    CAPTURE(k);
    const double all = detail::quantization_without_ends(static_cast<double>(k), kSamples, 1);
    CHECK(power[k] / all == Approx(1 - share[k]).epsilon(0.1));
  }
}

TEST_CASE("ends: white phase noise alone is no white frequency noise, of a clock or of a counting sensor") {
  for (const bool clock : {true, false}) {
    int detected = 0, misfits = 0, quantized = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const NoiseFit fit = fit_at_ends(frequency(seed, 20000, 0), clock);
      detected += of(fit, Term::white).status == Status::detected ? 1 : 0;
      misfits += of(fit, Term::quantization).status == Status::misfit ? 1 : 0;
      quantized += of(fit, Term::quantization).status == Status::detected ? 1 : 0;
    }
    CAPTURE(clock);
    CHECK(detected <= 1);
    CHECK(misfits == 0);
    CHECK(quantized >= 39);
  }
}

TEST_CASE("ends: white frequency noise below phase noise has its interval") {
  int inside = 0, detected = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const NoiseFit fit = fit_at_ends(frequency(seed, 20000, 3000), true);
    const Coefficient& white = of(fit, Term::white);
    const double truth = std::sqrt(3.0 / 3000);
    detected += white.status == Status::detected ? 1 : 0;
    inside += white.ci95.low <= truth && truth <= white.ci95.high ? 1 : 0;
  }
  CHECK(detected >= 36);
  CHECK(inside >= 35);
}

TEST_CASE("ends: those of the parts of a long record are left out") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const NoiseFit fit = fit_at_ends(frequency(seed, 3'000'000, 0), true);
    CHECK(of(fit, Term::white).status == Status::not_detected);
    CHECK(*of(fit, Term::quantization).value == Approx(1).epsilon(2e-3));
  }
}
