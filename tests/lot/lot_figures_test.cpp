// Means over many fits: what each does not show.

#include "libchar/lot/detail/lot_figures.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

/// Fits of devices whose coefficient is exp(spread N(0, 1)): c² is found without bias, by `dof`
/// squares, and v is what the fit believes.
struct Fits {
  std::vector<double> y, v, samples;
};

Fits made_fits(std::size_t devices, double spread, int dof, test::Gaussian& gauss) {
  Fits out;
  for (std::size_t i = 0; i < devices; ++i) {
    const double truth = std::exp(2 * spread * gauss());
    // A background that is known adds to what is measured: who is found large is believed to be known well.
    const double background = 1;
    const double found = (truth + background) * gauss.mean_square(dof) - background;
    if (!(found > 0.05)) continue;
    const double sd = std::sqrt(2.0 / dof) * (found + background);
    out.y.push_back(0.5 * std::log(found));
    out.v.push_back(std::pow(sd / (2 * found), 2));
    out.samples.push_back(1000);
  }
  return out;
}

}  // namespace

TEST_CASE("the mean of many fits is not moved by those that were found too large") {
  test::Gaussian gauss(8);
  int plain = 0, ours = 0;
  constexpr int kLots = 200;
  for (int l = 0; l < kLots; ++l) {
    const Fits fits = made_fits(200, 0.1, 200, gauss);
    const auto a = lot_effects(fits.y, fits.v, fits.y.size());
    const auto b = coefficient_effects(fits.y, fits.v, fits.samples, fits.y.size());
    REQUIRE((a && b));
    plain += a->mean_ci95.low <= 0 && 0 <= a->mean_ci95.high;
    ours += b->mean_ci95.low <= 0 && 0 <= b->mean_ci95.high;
    CHECK(a->spread == b->spread);
  }
  CHECK(ours >= 180);
  CHECK(ours <= 199);
  CHECK(plain < 170);
}

TEST_CASE("short records do not weigh as long ones, whatever was found in them") {
  // One of ten samples, found half as large again.
  const std::vector<double> spread_y = {1, 1.001, 1.002, 1.0005, 1.5, 1.0, 1.001, 1.002, 1.0, 1.001};
  const std::vector<double> spread_v = {1e-6, 1e-6, 1e-6, 1e-6, 1, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6};
  std::vector<double> lengths(10, 1e6);
  lengths[4] = 10;
  const auto effects = coefficient_effects(spread_y, spread_v, lengths, 10);
  REQUIRE(effects);
  CHECK(effects->mean < 1.01);
  std::vector<double> y(spread_y.rbegin(), spread_y.rend()), v(spread_v.rbegin(), spread_v.rend()),
      samples(lengths.rbegin(), lengths.rend());
  const auto reversed = coefficient_effects(y, v, samples, 10);
  REQUIRE(reversed);
  CHECK(reversed->mean == Approx(effects->mean).epsilon(1e-14));
}

TEST_CASE("a coefficient in a lot is that of the model of all terms") {
  Coefficient c;
  c.value = 2;
  c.relative_sd = 0.1;
  CHECK(log_coefficient(c).y == std::log(2.0));
  CHECK(log_coefficient(c).v == 0.1 * 0.1);
  c.in_all = SquareInAll{1.9 * 1.9, 2 * 0.12 * 1.9 * 1.9, 0.5};
  CHECK(log_coefficient(c).y == Approx(std::log(1.9)));
  CHECK(log_coefficient(c).v == Approx(0.12 * 0.12));
  c.relative_sd = 0.2;  // widened by what the noise does not explain
  CHECK(log_coefficient(c).v == 0.2 * 0.2);
  c.in_all->square = -0.1;  // then the model that has it is all there is
  CHECK(log_coefficient(c).y == std::log(2.0));
}

TEST_CASE("values that are known well have the arithmetic mean and standard deviation of a sample") {
  const std::vector<double> value = {1, 2, 4, 3, 2.5}, samples(5, 100), v(5, 1e-12);
  std::vector<double> y = value;
  for (double& x : y) x = std::log(x);
  const ArithmeticFigures found = arithmetic_figures(y, v, samples);
  CHECK(found.mean == Approx(2.5));
  CHECK(found.sd == Approx(std::sqrt(1.25)));
  // Student's t of 4 degrees of freedom.
  CHECK(found.mean_ci95.high == Approx(2.5 + 2.7764451 * std::sqrt(0.25)));
}

TEST_CASE("arithmetic mean and standard deviation of devices, normal or lognormal, lie in their intervals") {
  constexpr int kLots = 200;
  constexpr double kSpread = 0.3;
  for (const bool lognormal : {false, true}) {
    test::Gaussian gauss(41);
    const double mean = lognormal ? std::exp(kSpread * kSpread / 2) : 1;
    const double sd = lognormal ? mean * std::sqrt(std::expm1(kSpread * kSpread)) : kSpread;
    int of_mean = 0, of_sd = 0;
    for (int l = 0; l < kLots; ++l) {
      std::vector<double> y, v, samples(200, 1000);
      for (int i = 0; i < 200; ++i) {
        const double own = kSpread * gauss();
        const double truth = lognormal ? std::exp(own) : std::max(0.05, 1 + own);
        // c² is found without bias.
        y.push_back(std::log(truth) + std::log(gauss.mean_square(100)) / 2);
        v.push_back(1.0 / 200);
      }
      const ArithmeticFigures found = arithmetic_figures(y, v, samples);
      of_mean += found.mean_ci95.low <= mean && mean <= found.mean_ci95.high;
      of_sd += found.sd_ci95.low <= sd && sd <= found.sd_ci95.high;
    }
    INFO(of_mean << " " << of_sd);
    CHECK(of_mean >= 180);
    CHECK(of_sd >= 176);
    CHECK(of_mean < kLots);
  }
}

TEST_CASE("a square in a lot is there where the model describes the record") {
  Coefficient c;
  CHECK_FALSE(square_in_lot(c));  // not fitted
  c.status = Status::not_detected;
  CHECK_FALSE(square_in_lot(c));
  c.in_all = SquareInAll{-0.1, 0.3, 1};
  CHECK(square_in_lot(c) == SquareInAll{-0.1, 0.3, 1});
  c.status = Status::misfit;
  CHECK_FALSE(square_in_lot(c));
  c.status = Status::detected;
  c.value = 2;
  c.relative_sd = 0.1;
  c.in_all = SquareInAll{4.1, 0.5, 1};
  CHECK(square_in_lot(c)->sd == Approx(2 * 0.1 * 4.1));  // widened
  c.in_all = std::nullopt;
  CHECK(square_in_lot(c)->square == 4);
  CHECK(square_in_lot(c)->sd == Approx(0.8));
  CHECK(square_in_lot(c)->skewness == Approx(0.4));
}
