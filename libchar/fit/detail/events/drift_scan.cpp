// A warm-up a exp(-t/tau) begins with the record; of its time constant nothing is known, so that the largest score over a grid of
// tau is judged (look_elsewhere.hpp). Its coefficients fall as 1/k^2 beyond k = n/(pi tau): what comes after fifty times that is
// left out of the scan.
#include "libchar/fit/detail/events/drift_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace libchar {
namespace {

constexpr double kTauStep = 1.25;
constexpr double kLongest = 1.02;  ///< of the record: what takes longer is a ramp and its curvature

std::size_t room_for(double tau, const SeriesGrid& grid) {
  const double n = static_cast<double>(grid.points);
  return static_cast<std::size_t>(std::clamp(50 * n / (std::numbers::pi * tau), 64.0, n - 1));
}

std::vector<double> warm_up_column(double tau, const SeriesGrid& grid) {
  std::vector<double> column(std::min<std::size_t>(room_for(tau, grid), grid.points - 1));
  fill_column({EventKind::warm_up, 0, 0, tau}, grid, column);
  return column;
}

/// Standard deviation of the difference of two scores, regression aside.
double distance_between(const std::vector<double>& longer,
                        const std::vector<double>& shorter,
                        std::span<const double> weight) {
  const double both = weighted_product(weight, shorter, longer);
  const double square =
      weighted_product(weight, shorter, shorter) *
      weighted_product(
          weight, std::span(longer).first(shorter.size()), std::span(longer).first(shorter.size()));
  return std::sqrt(std::max(0.0, 2 - 2 * both / std::sqrt(square)));
}

}  // namespace

WarmUpScan scan_warm_ups(const Regression& beside,
                         const SeriesGrid& grid,
                         std::span<const double> weight) {
  WarmUpScan scan;
  const double n = static_cast<double>(grid.points);
  std::vector<double> before;
  for (double tau = std::max(8.0, n / 1000); tau < kLongest * n; tau *= kTauStep) {
    std::vector<double> column = warm_up_column(tau, grid);
    scan.tau.push_back(tau);
    scan.score.push_back(score_of(beside, column, weight).value());
    if (!before.empty()) scan.distance.push_back(distance_between(before, column, weight));
    if (std::abs(scan.score.back()) > std::abs(scan.score[scan.best]))
      scan.best = scan.score.size() - 1;
    before = std::move(column);
  }
  return scan;
}

double refined_tau(const WarmUpScan& scan,
                   const Regression& beside,
                   const SeriesGrid& grid,
                   std::span<const double> weight) {
  const auto gain = [&](double log_tau) {
    return std::abs(score_of(beside, warm_up_column(std::exp(log_tau), grid), weight).value());
  };
  const double centre = std::log(scan.tau[scan.best]);
  double low = centre - std::log(kTauStep);
  double high = std::min(centre + std::log(kTauStep), std::log(scan.tau.back()));
  for (int i = 0; i < 8; ++i) {  // thirds: down to a fiftieth of the grid's step
    const double third = (high - low) / 3;
    if (gain(low + third) > gain(high - third))
      high -= third;
    else
      low += third;
  }
  return std::exp(0.5 * (low + high));
}

Score ramp_score(const Regression& beside, const SeriesGrid& grid, std::span<const double> weight) {
  std::vector<double> column(grid.points - 1);
  fill_column({EventKind::ramp}, grid, column);
  return score_of(beside, column, weight);
}

}  // namespace libchar
