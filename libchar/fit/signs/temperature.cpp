// y = sum_j a_j (T_lag - mean)^j + noise, by generalised least squares in the cosine domain, where noise is
// uncorrelated (regression.cpp), in the metric of the noise that is fitted beside it. For every order the best lag of a
// grid is taken, the noise is fitted again without the temperature, and the order is offered
//   G = min(2 ln L(with, noise refitted) - 2 ln L(without, noise refitted), what it explains in the metric of the
//   refitted noise),
// judged by Davies' bound for the largest over the lags (temperature_columns.cpp), each order at a third of 1 %. From
// the first order that passes on, one more has to gain chi-square at 1 %. The interval of the first coefficient is the
// profile likelihood's over the lags.
#include "libchar/fit/signs/temperature.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/detail/events/regression.hpp"
#include "libchar/fit/detail/events/series_powers.hpp"
#include "libchar/fit/record/noise_powers.hpp"
#include "libchar/fit/signs/event.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

// Regressors of temperature in the cosine domain: powers of the lagged temperature, and what they explain.

/// Temperature at the points of a record's series, less its mean, in units of `scale`.
struct TemperatureSeries {
  std::vector<double> value;
  double mean = 0, scale = 1;
  Interval range;
};

/// The orders' columns for one lag: coefficients k = 1.. at [k-1] of the DCT-II of the powers 1..kTemperatureOrders.
using TemperatureColumns = std::array<std::vector<double>, kTemperatureOrders>;

/// Least squares of the first `order` columns with weights 1 / E c_k^2.
struct TemperatureFit {
  Eigen::VectorXd size;
  Eigen::MatrixXd covariance;
  double gain = 0;  ///< sum of weighted squares that they explain: chi-square of `order` degrees of freedom by chance
};

constexpr std::uint64_t kFewestTemperatures = 8;

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
      const double low = before < 0 ? value[static_cast<std::size_t>(t)] : value[static_cast<std::size_t>(before)],
                   high = t == n ? low : value[static_cast<std::size_t>(t)];
      const double share = static_cast<double>(i - before) / static_cast<double>(t - before);
      value[static_cast<std::size_t>(i)] = low + (high - low) * share;
    }
    before = t;
  }
  if (longest * 10 > n)
    throw numeric_error("E0703")
        .says("the temperature {} is missing for {} from {} s on, more than a tenth of the record", name,
              duration_text(static_cast<double>(longest) * step_s),
              place_text(static_cast<double>(longest_at) * step_s))
        .hint("read the stretch where it is present with `from_s` and `to_s`");
}

/// About its mean, in units of its scale. `value`: of each point, missing ones bridged.
void centre(TemperatureSeries& out) {
  for (const double value : out.value) out.mean += (value - out.range.low);
  out.mean = out.range.low + out.mean / static_cast<double>(out.value.size());
  double square = 0;
  for (double& value : out.value) {
    value -= out.mean;
    square += value * value;
  }
  out.scale = std::sqrt(square / static_cast<double>(out.value.size()));
  for (double& value : out.value) value /= out.scale;
}

/// Means over the samples that the points of `series` are means of; missing ones bridged. Throws Error(numeric) as
/// `find_temperature_effect` says.
TemperatureSeries temperature_series(const TemperatureRecord& temperature, const EventSeries& series, double rate_hz) {
  TemperatureSeries out;
  const auto first = clamped_whole<std::size_t>(std::round(series.start_s * rate_hz));
  std::uint64_t present = 0;
  out.range = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < series.value.size(); ++i) {
    double sum = 0, count = 0;
    for (std::size_t j = 0; j < series.per_point; ++j) {
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
    throw numeric_error("E0703").says(
        "the temperature {} has {} values where the channel has samples; at least {} are needed", temperature.name,
        present, kFewestTemperatures);
  if (!(out.range.low < out.range.high))
    throw numeric_error("E0703").says("the temperature {} is constant, {} throughout: its effect cannot be seen",
                                      temperature.name, brief_text(out.range.low, 6));
  bridge_temperature(out.value, temperature.name, series.step_s);
  centre(out);
  return out;
}

/// Behind a first-order lag of `lag` points (0: none).
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

TemperatureFit fit_temperature(std::span<const std::vector<double>> columns, std::span<const double> coefficients,
                               std::span<const double> weight) {
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd normal(count, count);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::vector<double>& x = columns[static_cast<std::size_t>(i)];
    right(i) = weighted_product(weight, x, coefficients);
    for (Eigen::Index j = 0; j <= i; ++j)
      normal(i, j) = normal(j, i) = weighted_product(weight, x, columns[static_cast<std::size_t>(j)]);
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

/// P(the largest gain over lags >= the largest of `gains`) of a record that temperature does not move; `gains` along
/// the lags.
double chance_of_gain(double gain, std::span<const double> gains, int order) {
  if (!(gain > 0)) return 1;
  double variation = 0;
  for (std::size_t i = 1; i < gains.size(); ++i) variation += std::abs(std::sqrt(gains[i]) - std::sqrt(gains[i - 1]));
  return std::min(1.0, chi_square_tail(gain, order) + variation * std::sqrt(gain) * chi_square_density(gain, order));
}

constexpr double kFalseAlarm = 0.01;
constexpr double kLagStep = 1.5;
constexpr double kShortestLag = 2000, kLongestLag = 8;  ///< the record over these

struct TemperatureSearch {
  const EventSeries& series;
  TemperatureSeries temperature;
  std::vector<double> coefficients;         ///< of the series, k = 1.. at [k-1]
  std::vector<double> lag;                  ///< in points
  std::vector<TemperatureColumns> columns;  ///< of each lag
};

/// Noise fitted to a series: E c_k^2 and what it says of the coefficients.
struct NoiseBeside {
  std::vector<double> power, weight;
  double deviance = 0;
};

std::vector<double> transformed(const std::vector<double>& value) {
  Dct dct(value.size());
  const std::span<const double> c = dct.transform(value);
  return {c.begin() + 1, c.end()};
}

NoiseBeside noise_beside(const EventSeries& left) {
  NoiseBeside noise;
  const std::vector<double> rest = transformed(left.value);
  noise.power = fitted_powers()(left).power;
  raise_to_measured(rest, noise.power);
  noise.deviance = deviance_of(rest, noise.power);
  for (const double power : noise.power) noise.weight.push_back(1 / power);
  return noise;
}

/// What the temperature does at each point of the series.
std::vector<double> effect_at_points(const TemperatureSeries& temperature, double lag, const Eigen::VectorXd& size) {
  std::vector<double> value = lagged(temperature.value, lag);
  double mean = 0;
  for (double& x : value) {
    double sum = 0;
    for (Eigen::Index j = size.size() - 1; j >= 0; --j) sum = (sum + size(j)) * x;
    x = sum;
    mean += sum / static_cast<double>(value.size());
  }
  for (double& x : value) x -= mean;
  return value;
}

EventSeries series_without(const TemperatureSearch& search, double lag, const Eigen::VectorXd& size) {
  EventSeries left = search.series;
  const std::vector<double> effect = effect_at_points(search.temperature, lag, size);
  for (std::size_t i = 0; i < effect.size(); ++i) left.value[i] -= effect[i];
  return left;
}

/// The fits of one order along the lags.
struct LagScan {
  std::vector<TemperatureFit> fit;
  std::vector<double> gain;
  std::size_t best = 0;
};

LagScan scan_lags(const TemperatureSearch& search, int order, const NoiseBeside& noise) {
  LagScan scan;
  for (const TemperatureColumns& columns : search.columns) {
    scan.fit.push_back(
        fit_temperature(std::span(columns).first(static_cast<std::size_t>(order)), search.coefficients, noise.weight));
    scan.gain.push_back(scan.fit.back().gain);
    if (scan.gain.back() > scan.gain[scan.best]) scan.best = scan.gain.size() - 1;
  }
  return scan;
}

/// An order with the noise fitted beside it.
struct TemperatureTrial {
  int order = 0;
  LagScan scan;
  NoiseBeside noise;
  double gain = 0, p = 1;
};

TemperatureTrial try_order(const TemperatureSearch& search, int order, const NoiseBeside& without) {
  TemperatureTrial trial;
  trial.order = order;
  trial.scan = scan_lags(search, order, without);
  for (int round = 0; round < 2; ++round) {
    const std::size_t at = trial.scan.best;
    trial.noise = noise_beside(series_without(search, search.lag[at], trial.scan.fit[at].size));
    trial.scan = scan_lags(search, order, trial.noise);
  }
  // What the refitted noise alone would gain is not the temperature's.
  trial.gain = std::min(without.deviance - trial.noise.deviance, trial.scan.gain[trial.scan.best]);
  trial.p = chance_of_gain(trial.gain, trial.scan.gain, order);
  return trial;
}

std::optional<TemperatureTrial> best_order(const TemperatureSearch& search, double& p) {
  const NoiseBeside without = noise_beside(search.series);
  std::optional<TemperatureTrial> best;
  p = 1;
  for (int order = 1; order <= static_cast<int>(kTemperatureOrders); ++order) {
    TemperatureTrial trial = try_order(search, order, without);
    p = std::min(p, trial.p * static_cast<double>(kTemperatureOrders));
    const bool passes = trial.p * static_cast<double>(kTemperatureOrders) < kFalseAlarm;
    const bool gains = !best || trial.gain - best->gain > chi_square_upper_quantile(kFalseAlarm, order - best->order);
    if (passes && gains) best = std::move(trial);
  }
  return best;
}

/// The lag between those of the grid, by thirds of the interval beside the best.
double refined_lag(const TemperatureSearch& search, const TemperatureTrial& trial) {
  const std::size_t best = trial.scan.best;
  const auto order = static_cast<std::size_t>(trial.order);
  double low = search.lag[best > 0 ? best - 1 : 0], high = search.lag[std::min(best + 1, search.lag.size() - 1)];
  const auto gain = [&](double lag) {
    const TemperatureColumns columns = temperature_columns(search.temperature, lag);
    return fit_temperature(std::span(columns).first(order), search.coefficients, trial.noise.weight).gain;
  };
  for (int i = 0; i < 8; ++i) {
    const double third = (high - low) / 3;
    if (gain(low + third) > gain(high - third))
      high -= third;
    else
      low += third;
  }
  const double middle = 0.5 * (low + high);
  return gain(middle) > trial.scan.gain[best] ? middle : search.lag[best];
}

/// Of the columns and of the change with the lag.
std::vector<double> leverage_at(const TemperatureSearch& search, double lag, const Eigen::VectorXd& size,
                                std::span<const double> weight) {
  const TemperatureColumns at = temperature_columns(search.temperature, lag);
  std::vector<std::vector<double>> columns(at.begin(), at.begin() + size.size());
  if (lag > 0) {
    constexpr double kApart = 1.05;
    const std::vector<double> more = transformed(effect_at_points(search.temperature, lag * kApart, size));
    std::vector<double> change = transformed(effect_at_points(search.temperature, lag / kApart, size));
    for (std::size_t k = 0; k < change.size(); ++k) change[k] -= more[k];
    columns.push_back(std::move(change));
  }
  return leverage_of(columns, fit_temperature(columns, search.coefficients, weight).covariance, weight);
}

/// The noise beside an effect whose degrees of freedom are counted: what the columns took from a coefficient is missing
/// in the rest.
NoiseBeside noise_beside_counted(const TemperatureSearch& search, double lag, const Eigen::VectorXd& size,
                                 std::span<const double> weight) {
  constexpr double kMostTaken = 0.9;
  EventSeries left = series_without(search, lag, size);
  const std::vector<double> taken = leverage_at(search, lag, size, weight), rest = transformed(left.value);
  CosineSums back(left.value.size());
  const std::span<double> c = back.input();
  c[0] = 0;
  for (std::size_t k = 0; k < rest.size(); ++k) c[k + 1] = rest[k] / std::sqrt(1 - std::min(taken[k], kMostTaken));
  const std::span<const double> value = back.transform();
  left.value.assign(value.begin(), value.end());
  return noise_beside(left);
}

/// How many coefficients the first column's information is spread over: the noise there is known no better.
double effective_coefficients(const std::vector<double>& column, std::span<const double> weight) {
  double sum = 0, square = 0;
  for (std::size_t k = 0; k < column.size(); ++k) {
    const double information = weight[k] * column[k] * column[k];
    sum += information;
    square += information * information;
  }
  return sum * sum / square;
}

/// Lags of the profile likelihood's interval, and that of the first coefficient over them.
void bound_effect(const TemperatureSearch& search, const LagScan& scan, double drop, TemperatureEffect& effect) {
  const double most = scan.gain[scan.best];
  const double step_s = search.series.step_s;
  effect.lag_ci95 = {search.lag.back() * step_s, 0};
  effect.ci95 = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < search.lag.size(); ++i) {
    const double slack = scan.gain[i] - most + drop;
    if (slack < 0) continue;
    // The lag is between its neighbours on the grid.
    const double below = search.lag[i > 0 ? i - 1 : 0] * step_s;
    const bool last = i + 1 == search.lag.size();
    effect.lag_ci95.low = std::min(effect.lag_ci95.low, below);
    effect.lag_ci95.high = last ? 0 : search.lag[i + 1] * step_s;
    const TemperatureFit& fit = scan.fit[i];
    const double half = std::sqrt(slack * fit.covariance(0, 0));
    effect.ci95.low = std::min(effect.ci95.low, fit.size(0) - half);
    effect.ci95.high = std::max(effect.ci95.high, fit.size(0) + half);
  }
  effect.ci95 = {effect.ci95.low / search.temperature.scale, effect.ci95.high / search.temperature.scale};
}

void describe_effect(const TemperatureSearch& search, const TemperatureTrial& trial, TemperatureEffect& effect) {
  const double lag = refined_lag(search, trial), scale = search.temperature.scale;
  const TemperatureColumns columns = temperature_columns(search.temperature, lag);
  const auto used = std::span(columns).first(static_cast<std::size_t>(trial.order));
  const Eigen::VectorXd first = fit_temperature(used, search.coefficients, trial.noise.weight).size;
  const NoiseBeside noise = noise_beside_counted(search, lag, first, trial.noise.weight);
  const TemperatureFit fit = fit_temperature(used, search.coefficients, noise.weight);
  const double dof = 2 * effective_coefficients(columns[0], noise.weight);
  const double student = student_quantile(0.975, dof);
  effect.order = trial.order;
  effect.gain = trial.gain;
  effect.lag_s = lag * search.series.step_s;
  for (int j = 0; j < trial.order; ++j)
    effect.coefficient[static_cast<std::size_t>(j)] = fit.size(j) / std::pow(scale, j + 1);
  effect.sd = std::sqrt(fit.covariance(0, 0)) / scale;
  bound_effect(search, scan_lags(search, trial.order, noise), student * student, effect);
  effect.value = effect_at_points(search.temperature, lag, fit.size);
  double square = 0;
  for (const double x : effect.value) square += x * x;
  effect.rms = std::sqrt(square / static_cast<double>(effect.value.size()));
  effect.leverage = leverage_at(search, lag, fit.size, noise.weight);
}

TemperatureEffect effect_of(TemperatureSearch search, const std::string& name, const std::string& unit) {
  search.coefficients = transformed(search.series.value);
  const double n = static_cast<double>(search.series.value.size());
  search.lag.push_back(0);
  for (double lag = std::max(1.0, n / kShortestLag); lag <= n / kLongestLag; lag *= kLagStep) search.lag.push_back(lag);
  for (const double lag : search.lag) search.columns.push_back(temperature_columns(search.temperature, lag));

  TemperatureEffect effect;
  effect.channel = name;
  effect.unit = unit;
  effect.mean = search.temperature.mean;
  effect.range = search.temperature.range;
  effect.per_point = static_cast<double>(search.series.per_point);
  const std::optional<TemperatureTrial> trial = best_order(search, effect.p);
  if (trial) describe_effect(search, *trial, effect);
  return effect;
}

}  // namespace

void check_temperature(const TemperatureRecord& temperature, double rate_hz) {
  EventSeries every;
  every.step_s = 1 / rate_hz;
  every.value = temperature.samples;
  temperature_series(temperature, every, rate_hz);
}

TemperatureEffect find_temperature_effect(std::span<const double> record, double rate_hz,
                                          const TemperatureRecord& temperature) {
  const EventSeries series = event_series(record, rate_hz);
  TemperatureEffect effect = effect_of({series, temperature_series(temperature, series, rate_hz), {}, {}, {}},
                                       temperature.name, temperature.unit);
  effect.first = std::round(series.start_s * rate_hz) + 0.5 * (effect.per_point - 1);
  return effect;
}

TemperatureEffect detail::temperature_effect_of_means(const EventSeries& series, const EventSeries& temperature,
                                                      const std::string& name, const std::string& unit) {
  TemperatureSeries means;
  means.value = temperature.value;
  const auto [low, high] = std::minmax_element(means.value.begin(), means.value.end());
  means.range = {*low, *high};
  if (!(*low < *high)) return {};
  centre(means);
  return effect_of({series, std::move(means), {}, {}, {}}, name, unit);
}

void add_temperature_effect(const TemperatureEffect& effect, double sign, std::span<double> record) {
  if (effect.value.empty()) return;
  const double last = static_cast<double>(effect.value.size() - 1);
  for (std::size_t t = 0; t < record.size(); ++t) {
    const double at = std::clamp((static_cast<double>(t) - effect.first) / effect.per_point, 0.0, last);
    const auto i = static_cast<std::size_t>(std::min(std::floor(at), std::max(0.0, last - 1)));
    const double share = at - static_cast<double>(i);
    const double next = effect.value[std::min(i + 1, effect.value.size() - 1)];
    record[t] += sign * (effect.value[i] + (next - effect.value[i]) * share);
  }
}

std::string temperature_sentence(const TemperatureEffect& effect, std::string_view unit) {
  if (effect.order == 0)
    return fmt::format(
        "It does not move with temperature ({}, {} to {} {}) beyond chance (p = {}): nothing was taken out.",
        effect.channel, number_text(effect.range.low, 4), number_text(effect.range.high, 4), effect.unit,
        number_text(effect.p, 2));
  const double relative = effect.sd / std::max(std::abs(effect.coefficient[0]), 1e-300);
  std::string lag = "no lag";
  if (effect.lag_s > 0)
    lag = fmt::format("a lag of {} ({} to {})", duration_text(effect.lag_s), duration_text(effect.lag_ci95.low),
                      effect.lag_ci95.high > 0 ? duration_text(effect.lag_ci95.high) : std::string("any length"));
  std::string text = fmt::format(
      "It moves with temperature ({}) by {} [{}, {}] {}/{} at {} {}, with {} and order {}; this was taken out before "
      "the noise was fitted.",
      effect.channel, number_text(effect.coefficient[0], digits_for(relative)),
      number_text(effect.ci95.low, digits_for(relative)), number_text(effect.ci95.high, digits_for(relative)),
      unit.empty() ? "U" : unit, "K", number_text(effect.mean, 4), effect.unit, lag, effect.order);
  if (effect.like_drift)
    text +=
        " A straight drift or a warm-up explains the record nearly as well: the record cannot tell them from "
        "temperature.";
  return text;
}

}  // namespace libchar
