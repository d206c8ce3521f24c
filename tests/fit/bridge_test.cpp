// Short runs of missing samples are filled with what could have stood there.
#include "libchar/fit/detail/band/bridge.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/remedies.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

using test::Record;

Record autoregressive(std::size_t n, double phi, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  Record y(n);
  double last = 0;
  for (double& value : y) value = last = phi * last + std::sqrt(1 - phi * phi) * gauss();
  return y;
}

Record with_missing(Record y, double share, std::size_t run, std::uint64_t seed) {
  test::Gaussian place(seed);
  for (std::size_t t = 0; t + run < y.size(); ++t)
    if (place.uniform() < share / static_cast<double>(run))
      for (std::size_t i = 0; i < run; ++i) y[t + i] = std::nan("");
  return y;
}

double mean_product(const Record& y, std::size_t lag) {
  double sum = 0;
  for (std::size_t t = lag; t < y.size(); ++t) sum += y[t] * y[t - lag];
  return sum / static_cast<double>(y.size() - lag);
}

}  // namespace

TEST_CASE("bridged records keep their variance and correlation") {
  for (const double phi : {0.0, 0.5, 0.95}) {
    const Record y = autoregressive(400000, phi, 3);
    const Record filled = bridged(with_missing(y, 0.04, 1, 8));
    REQUIRE(filled.size() == y.size());
    INFO(phi);
    std::size_t changed = 0;
    for (std::size_t t = 0; t < y.size(); ++t) changed += y[t] != filled[t];
    CHECK(static_cast<double>(changed) == Approx(16000).epsilon(0.05));
    CHECK(mean_product(filled, 0) == Approx(mean_product(y, 0)).epsilon(0.005));
    CHECK(mean_product(filled, 1) == Approx(mean_product(y, 1)).margin(0.005));
    CHECK(mean_product(filled, 2) == Approx(mean_product(y, 2)).margin(0.005));
  }
}

TEST_CASE("a phase is bridged where it was, however far its frequency is off") {
  test::Gaussian gauss(9);
  Record walk(20000);
  double level = 0;
  for (std::size_t t = 0; t < walk.size(); ++t) walk[t] = 1e4 * static_cast<double>(t) + (level += gauss());
  for (const std::size_t run : {std::size_t{1}, std::size_t{12}, std::size_t{700}}) {
    Record phase = with_missing(walk, 0.1, run, 4);
    detail::bridge_phase(phase);
    CHECK(std::none_of(phase.begin(), phase.end(), [](double value) { return std::isnan(value); }));
    double square = 0;
    for (std::size_t t = 1; t < phase.size(); ++t) square += std::pow(phase[t] - phase[t - 1] - 1e4, 2);
    INFO(run);
    CHECK(square / static_cast<double>(phase.size() - 1) == Approx(1).epsilon(0.06));
  }
  Record mostly = with_missing(walk, 0.9, 1, 4);
  detail::bridge_phase(mostly);
  CHECK(std::any_of(mostly.begin(), mostly.end(), [](double value) { return std::isnan(value); }));
  Record none = walk;
  detail::bridge_phase(none);
  CHECK(none == walk);
}

TEST_CASE("what is not bridged") {
  const Record y = autoregressive(20000, 0, 5);
  CHECK(bridged(y).empty());
  CHECK(bridged(with_missing(y, 0.2, 1, 2)).empty());
  CHECK(bridged(Record(50, std::nan(""))).empty());
  CHECK(bridged({}).empty());
  Record gap = y;
  gap[7] = gap[0] = gap.back() = std::nan("");
  for (std::size_t t = 500; t < 540; ++t) gap[t] = std::nan("");
  const Record filled = bridged(gap);
  CHECK(std::isfinite(filled[7]));
  CHECK(std::isnan(filled[0]));
  CHECK(std::isnan(filled.back()));
  for (std::size_t t = 500; t < 540; ++t) REQUIRE(std::isnan(filled[t]));
}

TEST_CASE("spikes, missing samples, a line and a drift at once are answered together") {
  const std::size_t n = 200000;
  test::NoiseSource source(n, 200, 21);
  for (int r = 0; r < 4; ++r) {
    Record y = source.record(1e-3, 1e-2, 5e-3);
    const double sd = 1e-3 * std::sqrt(200.0);
    for (std::size_t t = 0; t < n; ++t)
      y[t] += 0.5 * sd * std::sin(2 * M_PI * 0.250123 * static_cast<double>(t)) + 5e-6 * static_cast<double>(t);
    for (std::size_t t = 500; t < n; t += 997) y[t] += t % 2 == 0 ? 20 * sd : -20 * sd;
    y = with_missing(std::move(y), 0.01, 1, 30 + static_cast<std::uint64_t>(r));
    const NoiseFit fit = fit_record(y, 200, nullptr);
    INFO(r);
    // the bound of Q is 0.35 %; without the bridge it is off by eight of them
    CHECK(fit[Term::white].value.value() == Approx(1e-3).epsilon(0.0125));
  }
}
