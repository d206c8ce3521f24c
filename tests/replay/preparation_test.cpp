// Trends and filters that all sensors and the reference go through alike.
#include "libchar/replay/detail/preparation.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/replay/detail/instants.hpp"
#include "libchar/replay/replay.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

std::vector<double> filtered(const BandFilter& filter, const std::vector<double>& x) {
  FilteredChannel channel(filter);
  std::vector<double> out;
  for (const double value : x) out.push_back(channel(value));
  return out;
}

}  // namespace

TEST_CASE("band filter: Butterworth coefficients of scipy.signal.butter(2, …)") {
  const SecondOrderSection high = butterworth_high_pass(0.013);
  CHECK(high.b0 == Approx(0.9438775757370255).epsilon(1e-14));
  CHECK(high.b1 == Approx(-1.887755151474051).epsilon(1e-14));
  CHECK(high.a1 == Approx(-1.8846029408609604).epsilon(1e-14));
  CHECK(high.a2 == Approx(0.8909073620871416).epsilon(1e-14));
  const SecondOrderSection low = butterworth_low_pass(0.2);
  CHECK(low.b0 == Approx(0.20657208382614792).epsilon(1e-14));
  CHECK(low.b1 == Approx(0.41314416765229584).epsilon(1e-14));
  CHECK(low.a1 == Approx(-0.3695273773512414).epsilon(1e-14));
  CHECK(low.a2 == Approx(0.19581571265583306).epsilon(1e-14));
}

TEST_CASE("band filter: a band as scipy.signal.sosfilt runs it, begun in the first sample's steady state") {
  const BandFilter filter = band_filter(0.5, 12, 100);
  std::vector<double> x;
  for (int k = 0; k < 60; ++k) x.push_back(5 + std::sin(0.37 * k) + std::fmod(0.01 * k * k, 3));
  const std::vector<double> y = filtered(filter, x);
  CHECK(y[0] == 0);
  CHECK(y[1] == Approx(0.03318851187674564).epsilon(1e-10));
  CHECK(y[5] == Approx(0.8737826244339211).epsilon(1e-12));
  CHECK(y[30] == Approx(-0.47660857821061775).epsilon(1e-12));
  CHECK(y[59] == Approx(0.6516560999433023).epsilon(1e-12));
  CHECK(filter.noise_gain == Approx(0.2432937147614897).epsilon(1e-4));
  CHECK(band_filter(0.5, 0, 100).noise_gain == Approx(0.9888945600787588).epsilon(1e-4));
  CHECK(filter.settling == 330);
}

TEST_CASE("band filter: a step is below a thousandth once it has settled, an offset leaves nothing") {
  for (const double corner_hz : {0.01, 0.5, 20.0}) {
    const BandFilter filter = band_filter(corner_hz, 0, 100);
    std::vector<double> x(static_cast<std::size_t>(3 * filter.settling), 1e6);
    for (const double y : filtered(filter, x)) CHECK(y == 0);
    for (std::size_t k = 10; k < x.size(); ++k) x[k] += 1;
    const std::vector<double> y = filtered(filter, x);
    double largest = 0;
    for (std::size_t k = 10 + static_cast<std::size_t>(filter.settling); k < y.size(); ++k)
      largest = std::max(largest, std::abs(y[k]));
    CHECK(largest < 1e-3);
    CHECK(std::abs(y[10]) > 0.3);
  }
}

TEST_CASE("band filter: short gaps are bridged, long ones begin anew and are missing until settled") {
  const BandFilter filter = band_filter(0.1, 0, 100);
  REQUIRE(filter.settling == 1650);
  REQUIRE(filter.bridged == 16);
  std::vector<double> x(8000);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = 3 + std::sin(0.02 * static_cast<double>(k));
  const std::vector<double> whole = filtered(filter, x);
  auto gap = x;
  for (std::size_t k = 2000; k < 2003; ++k) gap[k] = kGap;
  const std::vector<double> bridged = filtered(filter, gap);
  for (std::size_t k = 2000; k < 2003; ++k) CHECK(std::isnan(bridged[k]));
  for (std::size_t k = 2003; k < 8000; k += 7) CHECK(std::abs(bridged[k] - whole[k]) < 2e-3);
  for (std::size_t k = 2000; k < 2100; ++k) gap[k] = kGap;
  const std::vector<double> anew = filtered(filter, gap);
  for (std::size_t k = 2000; k < 3750; ++k) CHECK(std::isnan(anew[k]));
  for (std::size_t k = 3750; k < 8000; k += 7) CHECK(std::abs(anew[k] - whole[k]) < 2e-3);
}

TEST_CASE("band filter: a difference of two channels is the difference filtered") {
  const BandFilter filter = band_filter(0.5, 12, 100);
  std::vector<double> a, b, d;
  for (int k = 0; k < 500; ++k) {
    a.push_back(7 + std::sin(0.05 * k));
    b.push_back(std::cos(0.3 * k));
    d.push_back(a.back() - b.back());
  }
  const auto fa = filtered(filter, a), fb = filtered(filter, b), fd = filtered(filter, d);
  for (std::size_t k = 0; k < fd.size(); ++k) CHECK(std::abs(fa[k] - fb[k] - fd[k]) < 1e-12);
}

TEST_CASE("trends: means and lines of least squares, missing samples left out") {
  TrendMeter meter;
  Eigen::MatrixXd block(3, 50);
  for (Eigen::Index part = 0; part < 4; ++part) {
    for (Eigen::Index k = 0; k < 50; ++k) {
      const double t = static_cast<double>(part * 50 + k);
      block(0, k) = 1e9 + 0.25 * t;
      block(1, k) = k % 2 == 0 ? kGap : 4;
      block(2, k) = kGap;
    }
    meter.push(part * 50, block);
  }
  const auto lines = meter.lines(true);
  CHECK(lines[0].slope == Approx(0.25).epsilon(1e-9));
  CHECK(lines[0].at(100) == Approx(1e9 + 25).epsilon(1e-15));
  CHECK(lines[1].at(17) == Approx(4).epsilon(1e-14));
  CHECK(lines[2].at(5) == 0);
  CHECK(meter.lines(false)[0].at(0) == Approx(1e9 + 0.25 * 99.5).epsilon(1e-15));
}
