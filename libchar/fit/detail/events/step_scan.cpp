// A step at t0 has the coefficients s_k = -sqrt(2/n) sin(pi k t0/n) / (2 sin(pi k/2n)). With weights W_k = 1 / E c_k^2 and
// coefficients r_k of what is not yet explained, for all t0 at once:
//   numerator    sum W s r = -sqrt(2/n) sum_k [W_k r_k / (2 sin)] sin(pi k t0/n)                one sum of sines
//   information  sum W s^2 = 1/2 (sum h - sum_k h_k cos(2 pi k t0/n)),  h = W (2/n) / (2 sin)^2  one inverse FFT
// less what the columns of the regression share with it (one sum of sines each). The numerators of neighbours differ by
// sqrt(2/n) sum W r cos(pi k (t0 + 1/2)/n), whose variance is the mean of W but at the ends: so the threshold knows how many
// independent scores there are. Interval of the place: the likelihood ratio of a change point has
// P(2 ln L falls by > x) = 1 - (1 - exp(-x/2))^2, 7.35 at 95 % (B. Hansen, Econometrica 68, 2000).
#include "libchar/fit/detail/events/step_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/fit/detail/events/turning.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

using std::numbers::pi;

constexpr double kPlaceDrop = 7.35;

/// 1 / (2 sin(pi k / 2n)) for k = 1..n-1 at [k-1].
std::vector<double> half_cosecants(std::uint64_t n) {
  std::vector<double> cosecant(n - 1);
  Turning half(pi / (2 * static_cast<double>(n)));
  for (double& value : cosecant) {
    half.next();
    value = 0.5 / half.sine;
  }
  return cosecant;
}

/// sum_k W_k s_k(t) x_k for every t.
std::vector<double> products(SineSums& sines,
                             std::span<const double> weight,
                             std::span<const double> cosecant,
                             std::span<const double> x) {
  const std::span<double> input = sines.input();
  const double scale = -std::sqrt(2 / static_cast<double>(input.size()));
  for (std::size_t k = 1; k < input.size(); ++k)
    input[k] = scale * weight[k - 1] * x[k - 1] * cosecant[k - 1];
  const std::span<const double> sums = sines.transform();
  return {sums.begin(), sums.end()};
}

/// [t]: sum W s^2 of a step at t. h is folded onto k <= n/2: cos(2 pi k t/n) is the same at n - k.
std::vector<double> step_information(std::span<const double> weight,
                                     std::span<const double> cosecant) {
  const std::size_t n = weight.size() + 1;
  RealFft fft(n);
  const auto bins = fft.coefficients();
  std::fill(bins.begin(), bins.end(), 0.0);
  double sum = 0;
  for (std::size_t k = 1; k < n; ++k) {
    const double h = 2 / static_cast<double>(n) * weight[k - 1] * cosecant[k - 1] * cosecant[k - 1];
    sum += h;
    bins[std::min(k, n - k)] += 2 * k == n ? h : h / 2;
  }
  const std::span<const double> cosines = fft.inverse();
  std::vector<double> information(n);
  for (std::size_t t = 0; t < n; ++t) information[t] = 0.5 * (sum - cosines[t]);
  return information;
}

/// What the columns already hold of a step at every place is taken from its information.
void subtract_shared(const Regression& beside,
                     const std::vector<std::vector<double>>& cross,
                     std::vector<double>& information) {
  std::vector<double> shared(information.size(), 0.0);
  for (std::size_t i = 0; i < cross.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const double times = (i == j ? 1 : 2) * beside.covariance(static_cast<Eigen::Index>(i),
                                                                static_cast<Eigen::Index>(j));
      for (std::size_t t = 0; t < shared.size(); ++t)
        shared[t] += times * cross[i][t] * cross[j][t];
    }
  for (std::size_t t = 0; t < information.size(); ++t) {
    const double left = information[t] - shared[t];
    information[t] = left > 0.01 * information[t] ? left : 0;
  }
}

}  // namespace

StepScan scan_steps(const Regression& beside,
                    std::span<const double> weight,
                    std::uint64_t points,
                    std::uint64_t margin) {
  const std::vector<double> cosecant = half_cosecants(points);
  SineSums sines(points);
  std::vector<double> information = step_information(weight, cosecant);
  double step = 0;
  for (const double w : weight) step += w / static_cast<double>(points);
  StepScan scan;
  for (std::uint64_t t = margin; t + 1 + margin < points; t += StepScan::kEvery) {
    const double both = std::sqrt(information[t] * information[t + 1]);
    const double shared = 0.5 * (information[t] + information[t + 1] - step);
    scan.distance.push_back(std::sqrt(std::max(0.0, 2 - 2 * shared / both)));
  }
  std::vector<std::vector<double>> cross;
  for (const std::vector<double>& column : beside.column)
    cross.push_back(products(sines, weight, cosecant, column));
  subtract_shared(beside, cross, information);
  scan.score = products(sines, weight, cosecant, beside.rest);
  for (std::uint64_t t = 0; t < points; ++t) {
    const bool looked_at = t >= margin && t + margin < points && information[t] > 0;
    scan.score[t] = looked_at ? scan.score[t] / std::sqrt(information[t]) : 0;
    if (std::abs(scan.score[t]) > std::abs(scan.score[scan.best])) scan.best = t;
  }
  return scan;
}

Interval step_place(const StepScan& scan, double at, std::uint64_t margin) {
  const std::size_t last = scan.score.size() - 1;
  const auto middle = std::min(last, static_cast<std::size_t>(at));
  const std::size_t reach = std::max<std::size_t>(margin, 8);
  std::size_t top = middle;
  for (std::size_t t = middle - std::min(middle, reach); t <= std::min(last, middle + reach); ++t)
    if (std::abs(scan.score[t]) > std::abs(scan.score[top])) top = t;
  const double best = scan.score[top], limit = best * best - kPlaceDrop;
  const auto in = [&](std::size_t t) {
    return scan.score[t] * best > 0 && scan.score[t] * scan.score[t] >= limit;
  };
  // Far away another step may stand: only what is joined to this place, but for dips shorter than the reach.
  std::size_t low = top, high = top;
  for (std::size_t t = top; t > 0 && low - t < reach; --t)
    if (in(t)) low = t;
  for (std::size_t t = top; t <= last && t - high < reach; ++t)
    if (in(t)) high = t;
  return {static_cast<double>(low), static_cast<double>(high)};
}

}  // namespace libchar
