#include "libchar/fit/signs/bursts.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

constexpr double kBurstRate = 100, kQuiet = 0.1;  // standard deviation 1
constexpr std::size_t kBurstSamples = 20000;

std::vector<double> quiet(test::Gaussian& normal) {
  std::vector<double> y(kBurstSamples);
  for (double& v : y) v = normal();
  return y;
}

/// `length` samples up or down by `height`, `share` of them all.
std::vector<double> with_bursts(test::Gaussian& normal, double height, double share, std::size_t length) {
  std::vector<double> y = quiet(normal);
  for (std::size_t t = 0; t + length < y.size(); ++t) {
    if (!(normal.uniform() < share / static_cast<double>(length))) continue;
    const double up = normal() < 0 ? -height : height;
    for (std::size_t i = t; i < t + length; ++i) y[i] += up;
  }
  return y;
}

std::optional<detail::Bursts> bursts_of(const std::vector<double>& y, std::span<const Event> events = {}) {
  return detail::find_bursts(event_series(y, kBurstRate), events);
}

}  // namespace

TEST_CASE("bursts: Gaussian noise of any colour has none") {
  test::Gaussian normal(5);
  int found = 0;
  for (int r = 0; r < 150; ++r) {
    std::vector<double> y = quiet(normal);
    double walk = 0, low = 0, swing = 0, before = 0;
    for (double& v : y) {
      const double drive = v;
      walk += 0.03 * normal();
      low += 0.05 * (drive - low);
      const double next = 1.93 * swing - 0.9604 * before + drive;  // a resonance of fifty samples
      before = std::exchange(swing, next);
      v = r % 3 == 0 ? drive + walk : r % 3 == 1 ? low : drive + 0.05 * swing;
    }
    found += bursts_of(y) ? 1 : 0;
  }
  CHECK(found == 0);
}

TEST_CASE("bursts: gaps that were bridged are none, and bursts between gaps are found") {
  test::Gaussian normal(9);
  for (const double height : {0.0, 6.0}) {
    std::vector<double> y = height > 0 ? with_bursts(normal, height, 0.01, 10) : quiet(normal);
    for (std::size_t t = 0; t < y.size(); ++t)
      if (t % 60 < 20) y[t] = std::nan("");
    CHECK(bursts_of(y).has_value() == (height > 0));
  }
}

TEST_CASE("bursts: short ones and long ones are found, with the share of the quiet part") {
  test::Gaussian normal(6);
  for (const std::size_t length : {3U, 10U, 30U}) {
    INFO(length << " samples");
    const auto found = bursts_of(with_bursts(normal, 6, 0.01, length));
    REQUIRE(found);
    CHECK(found->kurtosis > 4);
    CHECK(found->core < 0.9);
    CHECK(found->core > 0.4);
  }
}

TEST_CASE("bursts: a step that is known is none, a converter of coarse steps has none, a scale changes nothing") {
  test::Gaussian normal(7);
  std::vector<double> step = quiet(normal);
  for (std::size_t t = 8000; t < step.size(); ++t) step[t] += 50;
  CHECK(bursts_of(step));
  Event known;
  known.at_s = 80;
  known.size = 50;
  CHECK_FALSE(bursts_of(step, std::vector<Event>{known}));
  std::vector<double> coarse = quiet(normal);
  for (double& v : coarse) v = 3 * std::round(v / 3);
  CHECK_FALSE(bursts_of(coarse));
  std::vector<double> y = with_bursts(normal, 6, 0.01, 10), scaled = y;
  for (double& v : scaled) v = 1024 * v;
  CHECK(bursts_of(scaled)->core == bursts_of(y)->core);
}

TEST_CASE("bursts: a fit says them, and its interval reaches to the quiet part") {
  test::Gaussian normal(8);
  int held = 0, said = 0;
  for (int r = 0; r < 20; ++r) {
    const NoiseFit fit = fit_record(with_bursts(normal, 5, 0.006, 3), kBurstRate, nullptr, {});
    const Coefficient& white = fit[Term::white];
    held += white.ci95.low <= kQuiet && kQuiet <= white.ci95.high ? 1 : 0;
    said += std::any_of(fit.findings.begin(), fit.findings.end(),
                        [](const Finding& one) { return one.code == "heavy_tails"; })
                ? 1
                : 0;
  }
  CHECK(said == 20);
  CHECK(held >= 17);
}
