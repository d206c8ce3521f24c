// The mean over C channels scatters from device to device by s²(1 + C r)/C. Of D - 1 other devices the means alone
// know that by D - 2 degrees of freedom, too few in a small lot; what the channels scatter within the devices knows
// s² by (D - 1)(C - 1) more, but not r, the part that a device's channels share. So r is integrated out (Box & Tiao,
// Bayesian Inference in Statistical Analysis, 1973, ch. 5):
//   p(r | data) ~ p(r) (1 + C r)^(-f_b/2) S(r)^(-f/2),   S(r) = f_b MS_b / (1 + C r) + f_w MS_w,   f = f_b + f_w
// and the deviation of a device is Student's t of f degrees of freedom for each r. p(r): 0.4 for r = 0, the rest
// evenly in ln r from .05 to 1000. Alarms and power: tests/lot/device_outliers_test.cpp.
#include <algorithm>
#include <array>
#include <cmath>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/lot/detail/statistics/grouped_effects.hpp"

namespace libchar {
namespace {

/// The devices that are compared: mean over the channels of each, and its known variance.
struct DeviceMeans {
  std::vector<std::size_t> index;
  std::vector<double> mean, variance;
  double within = 0;  ///< mean square of a value about its device and channel
};

DeviceMeans device_means(std::span<const double> y, std::span<const double> v, std::size_t channels,
                         const std::vector<bool>& out) {
  DeviceMeans m;
  const auto count = static_cast<double>(channels);
  std::vector<double> channel(channels);
  double all = 0;
  for (std::size_t d = 0; d < out.size(); ++d) {
    if (out[d]) continue;
    double sum = 0, known = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      sum += y[d * channels + c];
      known += v[d * channels + c];
      channel[c] += y[d * channels + c];
    }
    m.index.push_back(d);
    m.mean.push_back(sum / count);
    m.variance.push_back(known / count);
    all += sum / count;
  }
  const auto devices = static_cast<double>(m.index.size());
  for (std::size_t i = 0; i < m.index.size(); ++i)
    for (std::size_t c = 0; c < channels; ++c) {
      const double off = y[m.index[i] * channels + c] - m.mean[i] - (channel[c] - all) / devices;
      m.within += off * off / ((devices - 1) * (count - 1));
    }
  return m;
}

/// How unlike the others the device is whose mean is farthest from theirs.
Outlier worst_device(const DeviceMeans& m, double channels) {
  const auto devices = static_cast<double>(m.mean.size());
  double mean = 0, known = 0, squares = 0;
  for (std::size_t i = 0; i < m.mean.size(); ++i) {
    mean += m.mean[i] / devices;
    known += m.variance[i] / devices;
  }
  for (const double one : m.mean) squares += (one - mean) * (one - mean);
  // A record that knows less of its device scatters more than the mean of all.
  const double within = std::max(m.within, known);
  const auto scale = [&](std::size_t i) { return 1 + (m.variance[i] - known) / within; };
  std::size_t worst = 0;
  double farthest = -1;
  for (std::size_t i = 0; i < m.mean.size(); ++i) {
    const double off = (m.mean[i] - mean) * (m.mean[i] - mean) / scale(i);
    if (off > farthest) worst = i;
    farthest = std::max(farthest, off);
  }
  const double off = (m.mean[worst] - mean) * devices / (devices - 1);
  const double f_b = devices - 2, f_w = (devices - 1) * (channels - 1), f = f_b + f_w;
  const double others = channels * std::max(0.0, squares - off * off * (devices - 1) / devices);
  constexpr double kNone = 0.4, kLow = 0.05, kHigh = 1000;
  std::array<double, 13> weight{}, shared{};
  double most = -1e300, sum = 0, p = 0;
  for (std::size_t k = 0; k < weight.size(); ++k) {
    shared[k] = k == 0 ? 0 : kLow * std::pow(kHigh / kLow, static_cast<double>(k - 1) / 11);
    const double factor = 1 + channels * shared[k], s = others / factor + f_w * within;
    weight[k] = std::log(k == 0 ? kNone : (1 - kNone) / 12) - (f_b * std::log(factor) + f * std::log(s)) / 2;
    most = std::max(most, weight[k]);
  }
  for (double& w : weight) sum += w = std::exp(w - most);
  double square = 0;
  for (std::size_t k = 0; k < weight.size(); ++k) {
    const double factor = 1 + channels * shared[k], s2 = (others / factor + f_w * within) / f;
    const double variance = s2 / channels * (scale(worst) + channels * shared[k] + factor / (devices - 1));
    p += weight[k] / sum * 2 * student_tail(std::abs(off) / std::sqrt(variance), f);
    square += weight[k] / sum * variance;
  }
  return {m.index[worst], off / std::sqrt(square), std::min(1.0, devices * p)};
}

}  // namespace

std::vector<Outlier> find_device_outliers(std::span<const double> value, std::span<const double> variance,
                                          std::size_t channels, double probability) {
  constexpr std::size_t kFew = 60;  // among more, nobody hides a second one
  const std::size_t devices = value.size() / channels;
  std::vector<bool> out(devices);
  std::vector<Outlier> found;
  std::size_t last = 0;
  while (devices - found.size() >= kFewestForOutliers && 3 * (found.size() + 1) <= devices) {
    const Outlier worst = worst_device(device_means(value, variance, channels, out), static_cast<double>(channels));
    found.push_back(worst);
    out[worst.index] = true;
    if (worst.p < probability / 2)
      last = found.size();
    else if (devices > kFew)
      break;
  }
  found.resize(last);
  for (Outlier& one : found) one.p = std::min(one.p, probability);
  return found;
}

}  // namespace libchar
