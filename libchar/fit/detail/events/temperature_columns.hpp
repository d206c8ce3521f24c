#pragma once
// Regressors of temperature in the cosine domain: powers of the lagged temperature, and what they explain.

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "libchar/fit/signs/event_series.hpp"
#include "libchar/fit/signs/temperature.hpp"

namespace libchar {

/// Temperature at the points of a record's series, less its mean, in units of `scale`.
struct TemperatureSeries {
  std::vector<double> value;
  double mean = 0, scale = 1;
  Interval range;
};

/// Means over the samples that the points of `series` are means of; missing ones bridged. Throws Error(numeric) as
/// `find_temperature_effect` says.
TemperatureSeries temperature_series(const TemperatureRecord& temperature,
                                     const EventSeries& series,
                                     double rate_hz);

/// Behind a first-order lag of `lag` points (0: none).
std::vector<double> lagged(std::span<const double> value, double lag);

/// The orders' columns for one lag: coefficients k = 1.. at [k-1] of the DCT-II of the powers 1..kTemperatureOrders.
using TemperatureColumns = std::array<std::vector<double>, kTemperatureOrders>;
TemperatureColumns temperature_columns(const TemperatureSeries& temperature, double lag);

/// Least squares of the first `order` columns with weights 1 / E c_k^2.
struct TemperatureFit {
  Eigen::VectorXd size;
  Eigen::MatrixXd covariance;
  double gain =
      0;  ///< sum of weighted squares that they explain: chi-square of `order` degrees of freedom by chance
};
TemperatureFit fit_temperature(std::span<const std::vector<double>> columns,
                               std::span<const double> coefficients,
                               std::span<const double> weight);

/// P(the largest gain over lags >= the largest of `gains`) of a record that temperature does not move; `gains` along the lags.
double chance_of_gain(double gain, std::span<const double> gains, int order);

}  // namespace libchar
