// The largest gain of `order` degrees of freedom over a parameter that means nothing under the null hypothesis (the lag):
//   P(max > g) <= P(chi2_s > g) + V g^((s-1)/2) e^(-g/2) 2^(-s/2) / Gamma(s/2),   V = total variation of sqrt(gain) along the lags
// (R. B. Davies, Biometrika 74, 1987, 33-43).
#include "libchar/fit/detail/events/temperature_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/core/numeric/chi_square.hpp"
#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/detail/events/regression.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kFewestTemperatures = 8;

[[noreturn]] void refuse_temperature(const std::string& what, const std::string& hint) {
  throw Error({ErrorKind::numeric, "E0703", "", what, "", hint});
}

/// Straight lines over missing points; the first and the last value are held beyond their ends.
void bridge_temperature(std::vector<double>& value, const std::string& name, double step_s) {
  const auto n = static_cast<std::ptrdiff_t>(value.size());
  std::ptrdiff_t before = -1, longest = 0, longest_at = 0;
  for (std::ptrdiff_t t = 0; t <= n; ++t) {
    if (t < n && std::isnan(value[static_cast<std::size_t>(t)])) continue;
    if (t - before - 1 > longest) {
      longest = t - before - 1;
      longest_at = before + 1;
    }
    for (std::ptrdiff_t i = before + 1; i < t; ++i) {
      const double low = before < 0 ? value[static_cast<std::size_t>(t)]
                                    : value[static_cast<std::size_t>(before)],
                   high = t == n ? low : value[static_cast<std::size_t>(t)];
      const double share = static_cast<double>(i - before) / static_cast<double>(t - before);
      value[static_cast<std::size_t>(i)] = low + (high - low) * share;
    }
    before = t;
  }
  if (longest * 10 > n)
    refuse_temperature(fmt::format("the temperature {} is missing for {} from {} s on, "
                                   "more than a tenth of the record",
                                   name,
                                   duration_text(static_cast<double>(longest) * step_s),
                                   place_text(static_cast<double>(longest_at) * step_s)),
                       "read the stretch where it is present with `from_s` and `to_s`");
}

}  // namespace

TemperatureSeries temperature_series(const TemperatureRecord& temperature,
                                     const EventSeries& series,
                                     double rate_hz) {
  TemperatureSeries out;
  const auto first = static_cast<std::size_t>(std::llround(series.start_s * rate_hz));
  std::uint64_t present = 0;
  out.range = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < series.value.size(); ++i) {
    double sum = 0, count = 0;
    for (std::uint64_t j = 0; j < series.per_point; ++j) {
      const std::size_t t = first + i * series.per_point + j;
      const double value = t < temperature.samples.size() ? temperature.samples[t] : std::nan("");
      if (!std::isfinite(value)) continue;
      sum += value;
      count += 1;
      out.range = {std::min(out.range.low, value), std::max(out.range.high, value)};
    }
    present += static_cast<std::uint64_t>(count);
    out.value.push_back(count > 0 ? sum / count : std::nan(""));
  }
  if (present < kFewestTemperatures)
    refuse_temperature(fmt::format("the temperature {} has {} values where the channel has "
                                   "samples; at least {} are needed",
                                   temperature.name,
                                   present,
                                   kFewestTemperatures),
                       "");
  if (!(out.range.low < out.range.high))
    refuse_temperature(fmt::format("the temperature {} is constant, {} throughout: what it "
                                   "does cannot be seen",
                                   temperature.name,
                                   brief_text(out.range.low, 6)),
                       "");
  bridge_temperature(out.value, temperature.name, series.step_s);
  for (const double value : out.value) out.mean += (value - out.range.low);
  out.mean = out.range.low + out.mean / static_cast<double>(out.value.size());
  double square = 0;
  for (double& value : out.value) {
    value -= out.mean;
    square += value * value;
  }
  out.scale = std::sqrt(square / static_cast<double>(out.value.size()));
  for (double& value : out.value) value /= out.scale;
  return out;
}

std::vector<double> lagged(std::span<const double> value, double lag) {
  std::vector<double> out(value.begin(), value.end());
  if (!(lag > 0)) return out;
  const double share = -std::expm1(-1 / lag);
  for (std::size_t t = 1; t < out.size(); ++t)
    out[t] = out[t - 1] + share * (0.5 * (value[t] + value[t - 1]) - out[t - 1]);
  return out;
}

TemperatureColumns temperature_columns(const TemperatureSeries& temperature, double lag) {
  const std::vector<double> one = lagged(temperature.value, lag);
  std::vector<double> power = one;
  Dct dct(one.size());
  TemperatureColumns columns;
  for (std::vector<double>& column : columns) {
    const std::span<const double> c = dct.transform(power);
    column.assign(c.begin() + 1, c.end());
    for (std::size_t t = 0; t < power.size(); ++t) power[t] *= one[t];
  }
  return columns;
}

TemperatureFit fit_temperature(std::span<const std::vector<double>> columns,
                               std::span<const double> coefficients,
                               std::span<const double> weight) {
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd normal(count, count);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::vector<double>& x = columns[static_cast<std::size_t>(i)];
    right(i) = weighted_product(weight, x, coefficients);
    for (Eigen::Index j = 0; j <= i; ++j)
      normal(i, j) = normal(j, i) =
          weighted_product(weight, x, columns[static_cast<std::size_t>(j)]);
  }
  const Eigen::VectorXd scale = normal.diagonal().array().rsqrt();
  Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  // Two temperatures give two powers: what the lower ones say already counts for nothing.
  scaled.diagonal().array() *= 1 + 1e-9;
  TemperatureFit fit;
  fit.covariance = scale.asDiagonal() * cholesky_inverse(scaled) * scale.asDiagonal();
  fit.size = fit.covariance * right;
  fit.gain = std::max(0.0, right.dot(fit.size));
  return fit;
}

double chance_of_gain(double gain, std::span<const double> gains, int order) {
  double variation = 0;
  for (std::size_t i = 1; i < gains.size(); ++i)
    variation += std::abs(std::sqrt(gains[i]) - std::sqrt(gains[i - 1]));
  const double half = 0.5 * order;
  const double rate =
      std::exp((half - 0.5) * std::log(gain) - gain / 2 - half * std::log(2.0) - std::lgamma(half));
  return gain > 0 ? std::min(1.0, chi_square_tail(gain, order) + variation * rate) : 1;
}

}  // namespace libchar
