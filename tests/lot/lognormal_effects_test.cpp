// Squares of which some are not told from zero.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "libchar/lot/detail/lot_figures.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

struct Squares {
  std::vector<double> square, sd, skewness, samples;
  SquareEstimates estimates() const { return {square, sd, skewness, samples}; }
};

/// Each found by an energy of chi-square with `dof` over what lies beneath.
Squares made(std::size_t count, double mean, double spread, double beneath, int dof, test::Gaussian& gauss,
             double samples = 1000) {
  Squares out;
  for (std::size_t i = 0; i < count; ++i) {
    const double square = std::exp(2 * (mean + spread * gauss()));
    const double found = (square + beneath) * gauss.mean_square(dof) - beneath;
    out.square.push_back(found);
    out.sd.push_back((std::max(found, 0.0) + beneath) * std::sqrt(2.0 / dof));
    out.skewness.push_back(2 * std::sqrt(2.0 / dof));
    out.samples.push_back(samples);
  }
  return out;
}

bool in_interval(const Interval& i, double value) { return i.low <= value && value <= i.high; }

}  // namespace

TEST_CASE("squares that are well known have the mean and spread of their logarithms") {
  test::Gaussian gauss(3);
  const Squares in = made(40, -1, 0.4, 1e-9, 100000, gauss);
  double mean = 0, square = 0;
  for (const double q : in.square) mean += std::log(q) / 2 / 40;
  for (const double q : in.square) square += std::pow(std::log(q) / 2 - mean, 2) / 39;
  const LognormalEffects found = lognormal_effects(in.estimates());
  CHECK(found.count == 40);
  CHECK(found.mean == Approx(mean).margin(1e-3));
  CHECK(found.spread == Approx(std::sqrt(square)).epsilon(2e-2));
  CHECK(found.arithmetic == Approx(found.mean + found.spread * found.spread / 2));
  // Student's t of 39 degrees of freedom.
  const double half = 2.0227 * std::sqrt(square / 40);
  CHECK(found.mean_ci95.low == Approx(mean - half).margin(0.03 * half));
  CHECK(found.mean_ci95.high == Approx(mean + half).margin(0.03 * half));
}

TEST_CASE("mean and spread of squares, of which many are below zero, lie in their intervals") {
  constexpr int kLots = 200;
  for (const double spread : {0.1, 0.5}) {
    test::Gaussian gauss(17);
    int mean = 0, arithmetic = 0, width = 0, negative = 0;
    for (int i = 0; i < kLots; ++i) {
      const Squares in = made(60, 2, spread, 3 * std::exp(4.0), 20, gauss);
      const LognormalEffects found = lognormal_effects(in.estimates());
      mean += in_interval(found.mean_ci95, 2);
      arithmetic += in_interval(found.arithmetic_ci95, 2 + spread * spread / 2);
      width += in_interval(found.spread_ci95, spread);
      for (const double q : in.square) negative += q < 0;
    }
    INFO("spread " << spread << ": " << mean << " " << arithmetic << " " << width);
    CHECK(negative > 0.1 * 60 * kLots);
    CHECK(negative < 0.3 * 60 * kLots);
    // 95 % of 200, and four standard deviations of that.
    for (const int inside : {mean, arithmetic, width}) CHECK(inside >= 178);
    CHECK(mean < kLots);
  }
}

TEST_CASE("a scale multiplies, an order does not matter, many values are taken together") {
  test::Gaussian gauss(5);
  Squares in = made(50, 0, 0.3, 2, 20, gauss);
  const LognormalEffects found = lognormal_effects(in.estimates());
  Squares other = in;
  for (std::vector<double>* of : {&other.square, &other.sd}) {
    for (double& x : *of) x *= 1e-12;
    std::reverse(of->begin(), of->end());
  }
  const LognormalEffects scaled = lognormal_effects(other.estimates());
  const double ln = std::log(1e-12) / 2;
  CHECK(scaled.mean == Approx(found.mean + ln).margin(1e-4));
  CHECK(scaled.spread == Approx(found.spread).epsilon(1e-3));
  CHECK(scaled.mean_ci95.high == Approx(found.mean_ci95.high + ln).margin(1e-4));
  CHECK(scaled.spread_ci95.high == Approx(found.spread_ci95.high).epsilon(1e-3));
  const Squares many = made(100000, 0, 0.3, 2, 20, gauss);
  const LognormalEffects of_many = lognormal_effects(many.estimates());
  CHECK(of_many.mean == Approx(0).margin(0.03));
  CHECK(of_many.spread == Approx(0.3).epsilon(0.1));
}

TEST_CASE("records of unlike lengths have errors of their own, and one sd that is far off bends no line") {
  test::Gaussian gauss(11);
  Squares in = made(150, 1, 0.2, 20, 30, gauss);
  const Squares longer = made(50, 1, 0.2, 0.5, 400, gauss, 16000);
  for (std::size_t i = 0; i < 50; ++i) {
    in.square.push_back(longer.square[i]);
    in.sd.push_back(longer.sd[i]);
    in.skewness.push_back(longer.skewness[i]);
    in.samples.push_back(longer.samples[i]);
  }
  in.sd[0] *= 1e-5;
  const LognormalEffects found = lognormal_effects(in.estimates());
  CHECK(in_interval(found.mean_ci95, 1));
  CHECK(found.mean_ci95.high - found.mean_ci95.low < 0.15);
  CHECK(in_interval(found.spread_ci95, 0.2));
  CHECK(found.spread_ci95.high < 0.35);
}

TEST_CASE("a hundred thousand squares that are well known keep a small spread") {
  test::Gaussian gauss(19);
  Squares in;
  for (int i = 0; i < 100000; ++i) {
    in.square.push_back(std::exp(2 * 0.01 * gauss()) * (1 + 1e-3 * gauss()));
    in.sd.push_back(1e-3 * in.square.back());
    in.skewness.push_back(0.01);
    in.samples.push_back(1e6);
  }
  const LognormalEffects known = lognormal_effects(in.estimates());
  CHECK(known.spread == Approx(0.01).epsilon(0.02));
  CHECK(known.mean == Approx(0).margin(2e-4));
}

TEST_CASE("few values of unlike sizes have intervals with both ends") {
  const std::vector<double> ln = {-3, -3.2, -2.9, -7.8, -7.6, -7.9};
  std::vector<double> square, sd;
  for (const double y : ln) square.push_back(std::exp(2 * y));
  for (const double q : square) sd.push_back(0.01 * q);
  const std::vector<double> skewness(6, 0.02), samples(6, 1e6);
  const LognormalEffects found = lognormal_effects({square, sd, skewness, samples});
  // Of the logarithms: mean -5.4, standard deviation 2.603; Student's t of 5 degrees of freedom,
  // chi-square by its likelihood.
  const double half = 2.5706 * 2.603 / std::sqrt(6.0);
  CHECK(found.mean == Approx(-5.4).margin(0.1));
  CHECK(found.mean_ci95.low == Approx(-5.4 - half).epsilon(0.05));
  CHECK(found.mean_ci95.high == Approx(-5.4 + half).epsilon(0.1));
  CHECK(found.spread == Approx(2.603).epsilon(0.05));
  CHECK(found.spread_ci95.high < 9);
}

TEST_CASE("squares that show no spread, or hardly a value, say so by their intervals") {
  test::Gaussian gauss(23);
  const LognormalEffects alike = lognormal_effects(made(30, 0, 0, 1, 20, gauss).estimates());
  CHECK(alike.spread_ci95.low == 0);
  CHECK(alike.spread_ci95.high < 0.4);
  const std::vector<double> square = {-0.5, 0.4, 0.3}, sd = {1, 1.2, 1.2}, skewness = {0, 0, 0},
                            samples = {100, 100, 100};
  const LognormalEffects few = lognormal_effects({square, sd, skewness, samples});
  CHECK(std::isfinite(few.mean));
  CHECK(few.mean_ci95.high > 0.5);
  CHECK(std::isfinite(few.spread));
  const std::vector<double> hardly = {-0.5, 1e-4, -0.3};
  const LognormalEffects nothing = lognormal_effects({hardly, sd, skewness, samples});
  CHECK(std::isfinite(nothing.mean));
  CHECK(nothing.mean_ci95.low == -std::numeric_limits<double>::infinity());
}
