// The variance-time plot (J. Beran, Statistics for Long-Memory Processes, 1994, 4.4). Means of k
// batches of m of the n values scatter by
//   V_k = g(m) - g(n),   g(m) the variance of a mean of m values,
// for the mean of all is taken out of them. g is (m/n)^-1 times a constant where batches are longer
// than the correlation, and falls slower where it never ends: g(m) = a (m/n)^-1 + b (m/n)^-1/4, a
// and b >= 0, fitted to V_256 … V_8, each a gamma variable of k - 1 degrees of freedom. What is
// wanted is g(n) = a + b: no batch has seen it, where b > 0. The second term is left out where the
// batches do not ask for it, first without the shortest, which are correlated soonest; and it is that of a
// correlation that ends, exp(-t/T) with T of a ninetieth of the record or less, where that is clearly likelier.
#include "libchar/replay/detail/judge/mean_uncertainty.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/distributions.hpp"

namespace libchar {
namespace {

constexpr std::array<std::size_t, 6> kBatches = {256, 128, 64, 32, 16, 8};
constexpr double kAsked = 0.5;  ///< in deviance: rather a wide interval than a false one
constexpr std::array kEndingTimes = {1. / 512, 1. / 362, 1. / 256, 1. / 181, 1. / 128, 1. / 90};  ///< T over the record
constexpr double kLikelier = 1.5;                                                                 ///< in deviance
constexpr int kRounds = 6;

std::vector<double> batch_means(std::span<const double> series, std::size_t batches) {
  const std::size_t length = series.size() / batches;
  std::vector<double> means(batches, 0.0);
  for (std::size_t i = 0; i < batches; ++i) {
    for (std::size_t k = 0; k < length; ++k) means[i] += series[i * length + k];
    means[i] /= static_cast<double>(length);
  }
  return means;
}

double variance_of(const std::vector<double>& values) {
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return squares / static_cast<double>(values.size() - 1);
}

/// What the scatter of batches of one length says.
struct BatchVariance {
  double variance = 0, freedom = 0, share = 0;  ///< of the record, in a batch
  std::array<double, 2> unit{};                 ///< of the two terms
};

struct Plot {
  std::array<double, 2> weight{};  ///< of the two terms
  double deviance = 0;
};

double expected(const BatchVariance& batch, const std::array<double, 2>& weight) {
  return std::max(weight[0] * batch.unit[0] + weight[1] * batch.unit[1], std::numeric_limits<double>::min());
}

/// Least squares of two terms, neither negative, each row over what it is expected to be.
std::array<double, 2> weighted_fit(std::span<const BatchVariance> batches, const std::vector<double>& scale,
                                   bool both) {
  double aa = 0, ab = 0, bb = 0, ay = 0, by = 0;
  for (std::size_t i = 0; i < batches.size(); ++i) {
    const double w = batches[i].freedom / (2 * scale[i] * scale[i]);
    const auto [a, b] = batches[i].unit;
    aa += w * a * a;
    ab += w * a * b;
    bb += w * b * b;
    ay += w * a * batches[i].variance;
    by += w * b * batches[i].variance;
  }
  const std::array<double, 2> first = {ay / aa, 0}, second = {0, by / bb};
  if (!both) return first;
  const double determinant = aa * bb - ab * ab;
  const std::array<double, 2> free = {(bb * ay - ab * by) / determinant, (aa * by - ab * ay) / determinant};
  if (free[0] >= 0 && free[1] >= 0) return free;
  return ay * ay / aa > by * by / bb ? first : second;
}

Plot fitted(std::span<const BatchVariance> batches, bool both) {
  Plot plot;
  std::vector<double> scale;
  for (const BatchVariance& batch : batches) scale.push_back(batch.variance);
  for (int round = 0; round < kRounds; ++round) {
    plot.weight = weighted_fit(batches, scale, both);
    for (std::size_t i = 0; i < batches.size(); ++i) scale[i] = expected(batches[i], plot.weight);
  }
  for (std::size_t i = 0; i < batches.size(); ++i) {
    const double u = batches[i].variance / scale[i];
    plot.deviance += batches[i].freedom * (u - 1 - std::log(u));
  }
  return plot;
}

MeanUncertainty answer(const Plot& plot, double freedom, double level) {
  MeanUncertainty out;
  out.sd = std::sqrt(plot.weight[0] + plot.weight[1]);
  out.reach95 = out.sd * student_quantile(1 - level / 2, freedom);
  out.long_memory = plot.weight[1] > 0;
  return out;
}

/// Variance of the mean of a share of the record, of a correlation exp(-t/T).
double of_ending(double share, double time) {
  const double q = time / share;
  return 2 * q * (1 - q * (1 - std::exp(-1 / q)));
}

}  // namespace

MeanUncertainty mean_uncertainty(std::span<const double> series, double level, double endless) {
  std::vector<BatchVariance> batches;
  for (const std::size_t count : kBatches) {
    if (count > series.size()) continue;
    const std::size_t whole = series.size() / count;
    const double share = static_cast<double>(whole) / static_cast<double>(series.size());
    const double variance = variance_of(batch_means(series, count));
    if (!(variance > 0)) return {0, 0, false};
    batches.push_back(
        {variance, static_cast<double>(count - 1), share, {1 / share - 1, std::pow(share, -endless) - 1}});
  }
  if (batches.empty()) return {kNone, kNone, false};
  constexpr std::size_t kFewest = 4;  // lengths, to tell two terms apart
  const std::span all(batches);
  for (std::size_t first = 0; first == 0 || first + kFewest <= batches.size(); ++first) {
    const auto rest = all.subspan(first);
    const Plot one = fitted(rest, false);
    if (one.deviance - fitted(rest, true).deviance < kAsked) return answer(one, (rest[0].freedom + 1) / 4, level);
  }
  const Plot slow = fitted(all, true);
  MeanUncertainty out = answer(slow, kBatches.back() - 1, level);
  double least = slow.deviance - kLikelier;
  for (const double time : kEndingTimes) {
    for (BatchVariance& batch : batches) batch.unit[1] = of_ending(batch.share, time) / of_ending(1, time) - 1;
    const Plot ending = fitted(batches, true);
    if (ending.deviance >= least) continue;
    least = ending.deviance;
    out = answer(ending, 1 / (8 * time), level);
    out.long_memory = false;
  }
  return out;
}

double slow_slope(std::span<const double> series) {
  constexpr std::size_t kMost = 128;
  if (series.size() < kMost) return kNone;
  double weights = 0, x1 = 0, y1 = 0, xx = 0, xy = 0;
  for (std::size_t batches = kMost; batches >= 8; batches /= 2) {
    const std::vector<double> means = batch_means(series, batches);
    double squares = 0;
    for (std::size_t i = 1; i < batches; ++i) squares += std::pow(means[i] - means[i - 1], 2);
    if (!(squares > 0)) return kNone;
    const double x = -std::log(static_cast<double>(batches));
    const double y = std::log(squares / static_cast<double>(batches - 1));
    const double w = std::sqrt(static_cast<double>(batches));
    weights += w;
    x1 += w * x;
    y1 += w * y;
    xx += w * x * x;
    xy += w * x * y;
  }
  return (xy - x1 * y1 / weights) / (xx - x1 * x1 / weights);
}

}  // namespace libchar
