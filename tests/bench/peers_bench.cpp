// Our fit against the estimators of imu_utils and allan_variance_ros, and a relative least squares as in nmayorov's script, on the same
// simulated records; and against the published fits of imu_utils on its own curves of six real IMUs.
// Usage: peers_bench [records a scene = 12] [scene numbers = all]
//
// The estimators are written anew from their descriptions (not from their code):
//   allan_variance_ros   averages of 0.1 s, 0.2 s … 999.9 s side by side without overlap; Q: mean of ln σ√τ for τ < 10 s; K: √3 times the
//                        geometric mean of σ/√τ over all periods; B: the lowest σ.
//   imu_utils            overlapping AVAR at 100 logarithmic strides up to the largest power of two below N/2; least squares on
//                        log10 AVAR, equal weights, five squared coefficients (2 ln 2/π B² for flicker).
//   relative NNLS        overlapping AVAR at 100 logarithmic strides up to N/10; Σ (model/AVAR - 1)², coefficients not negative.
// imu_utils' objective is minimised from four starts around the third, so that it is compared and not an optimizer.

#include <fmt/format.h>

#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/curve_fit.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/curves.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace libchar;
using test::numbers;
using test::rms_log10;
using Clock = std::chrono::steady_clock;
using Values = std::array<double, 3>;  // Q, B, K; 0 = absent

struct Scene {
  std::string name;
  double rate_hz;
  std::size_t samples;
  Values truth;
};

const std::vector<Scene> kScenes = {
    {"Q", 100, 1080000, {2.5e-3, 0, 0}},
    {"Q K", 100, 1080000, {2.502e-3, 0, 6.97e-5}},
    {"Q B K", 100, 1080000, {2.5e-3, 6e-4, 7e-6}},
    {"fixture gyro_z", 50, 50000, {4e-3, 4e-3, 1.5e-3}},
    {"fixture accel_z", 50, 50000, {1e-4, 0, 0}},
};

// ---- Allan variances, each tool's own points ----

struct Curve {
  std::vector<double> tau, variance;
};

std::vector<double> centred_sums(const std::vector<double>& y) {
  double mean = 0;
  for (const double v : y) mean += v / static_cast<double>(y.size());
  std::vector<double> sums(y.size() + 1);
  for (std::size_t i = 0; i < y.size(); ++i) sums[i + 1] = sums[i] + (y[i] - mean);
  return sums;
}

double allan_variance_of(const std::vector<double>& sums, std::size_t m, std::size_t step) {
  double sum = 0;
  std::size_t terms = 0;
  for (std::size_t i = 0; i + 2 * m < sums.size(); i += step, ++terms) {
    const double d = sums[i + 2 * m] - 2 * sums[i + m] + sums[i];
    sum += d * d;
  }
  return terms == 0 ? 0
                    : sum / (2 * static_cast<double>(terms) * static_cast<double>(m) *
                             static_cast<double>(m));
}

Curve logarithmic_points(const std::vector<double>& sums, double rate_hz, double largest) {
  Curve curve;
  std::size_t last = 0;
  for (int i = 0; i < 100; ++i) {
    const auto m = static_cast<std::size_t>(std::pow(largest, i / 99.0));
    if (m == last || 2 * m + 1 >= sums.size()) continue;
    last = m;
    curve.tau.push_back(static_cast<double>(m) / rate_hz);
    curve.variance.push_back(allan_variance_of(sums, m, 1));
  }
  return curve;
}

Curve linear_periods(const std::vector<double>& sums, double rate_hz) {
  Curve curve;
  for (int period = 1; period < 10000; ++period) {
    const auto m = static_cast<std::size_t>(std::lround(0.1 * period * rate_hz));
    if (sums.size() < 4 * m) break;
    curve.tau.push_back(static_cast<double>(m) / rate_hz);
    curve.variance.push_back(allan_variance_of(sums, m, m));
  }
  return curve;
}

// ---- the peers' estimators ----

Values allan_variance_ros(const std::vector<double>& y, double rate_hz) {
  const Curve curve = linear_periods(centred_sums(y), rate_hz);
  double q = 0, k = 0, lowest = INFINITY;
  int short_ones = 0;
  for (std::size_t i = 0; i < curve.tau.size(); ++i) {
    const double log_sd = 0.5 * std::log(curve.variance[i]), half = 0.5 * std::log(curve.tau[i]);
    if (curve.tau[i] < 10) q += log_sd + half, ++short_ones;
    k += log_sd - half;
    lowest = std::min(lowest, std::sqrt(curve.variance[i]));
  }
  return {std::exp(q / short_ones),
          lowest,
          std::sqrt(3.0) * std::exp(k / static_cast<double>(curve.tau.size()))};
}

// AVAR of unit coefficients, continuous asymptotes: quantization, white, flicker, walk, ramp.
Eigen::Matrix<double, 1, 5> units(double tau) {
  return {
      3 / (tau * tau), 1 / tau, 2 * std::numbers::ln2 / std::numbers::pi, tau / 3, tau * tau / 2};
}

// Σ (Σ θ u / v - 1)² over θ >= 0: of all 31 subsets the best whose solution is not negative.
Eigen::VectorXd relative_nnls(const Curve& curve) {
  const auto n = static_cast<Eigen::Index>(curve.tau.size());
  Eigen::MatrixXd a(n, 5);
  for (Eigen::Index i = 0; i < n; ++i)
    a.row(i) =
        units(curve.tau[static_cast<std::size_t>(i)]) / curve.variance[static_cast<std::size_t>(i)];
  Eigen::VectorXd best = Eigen::VectorXd::Zero(5);
  double lowest = static_cast<double>(n);
  for (unsigned subset = 1; subset < 32; ++subset) {
    std::vector<Eigen::Index> columns;
    for (Eigen::Index c = 0; c < 5; ++c)
      if ((subset >> static_cast<unsigned>(c) & 1U) != 0) columns.push_back(c);
    Eigen::MatrixXd part = a(Eigen::all, columns);
    const Eigen::RowVectorXd scale = part.colwise().norm();
    part.array().rowwise() /= scale.array();
    const Eigen::VectorXd x = test::solution(part, Eigen::VectorXd::Ones(n));
    const double misfit = (part * x - Eigen::VectorXd::Ones(n)).squaredNorm();
    if (x.minCoeff() < 0 || misfit >= lowest) continue;
    lowest = misfit;
    best.setZero();
    for (std::size_t c = 0; c < columns.size(); ++c)
      best[columns[c]] = x[static_cast<Eigen::Index>(c)] / scale[static_cast<Eigen::Index>(c)];
  }
  return best;
}

struct Fitted {
  Eigen::VectorXd theta;
  double misfit = INFINITY;
};

// Levenberg-Marquardt on log10 AVAR in coefficients whose squares are the variances. `least`: how much of the measured variance an
// absent coefficient starts with (at 0 it would stay there).
Fitted log_least_squares(const Curve& curve, const Eigen::VectorXd& start, double least) {
  const auto n = static_cast<Eigen::Index>(curve.tau.size());
  Eigen::MatrixXd unit(n, 5);
  for (Eigen::Index i = 0; i < n; ++i) unit.row(i) = units(curve.tau[static_cast<std::size_t>(i)]);
  // Scaled so that each coefficient at 1 makes the whole variance somewhere; absent ones start small, not at the stationary point 0.
  Eigen::VectorXd scale(5);
  for (Eigen::Index c = 0; c < 5; ++c) {
    scale[c] = INFINITY;
    for (Eigen::Index i = 0; i < n; ++i)
      scale[c] = std::min(scale[c], curve.variance[static_cast<std::size_t>(i)] / unit(i, c));
  }
  Eigen::VectorXd c = (start.cwiseQuotient(scale)).cwiseMax(least).cwiseSqrt();
  const auto residuals = [&](const Eigen::VectorXd& at, Eigen::MatrixXd* jacobian) {
    Eigen::VectorXd r(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double model = unit.row(i) * at.cwiseAbs2().cwiseProduct(scale);
      r[i] = std::log10(model / curve.variance[static_cast<std::size_t>(i)]);
      if (jacobian != nullptr)
        jacobian->row(i) = (2 / (model * std::numbers::ln10)) *
                           unit.row(i).transpose().cwiseProduct(scale).cwiseProduct(at);
    }
    return r;
  };
  double damping = 1e-3;
  Eigen::MatrixXd jacobian(n, 5);
  Eigen::VectorXd r = residuals(c, &jacobian);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    Eigen::MatrixXd damped = normal;
    damped.diagonal() += damping * (normal.diagonal().array() + 1e-12).matrix();
    const Eigen::VectorXd next = c - test::solution(damped, jacobian.transpose() * r);
    const Eigen::VectorXd tried = residuals(next, nullptr);
    if (tried.squaredNorm() < r.squaredNorm()) {
      const bool done = r.squaredNorm() - tried.squaredNorm() < 1e-14 * r.squaredNorm();
      c = next;
      r = residuals(c, &jacobian);
      damping *= 0.3;
      if (done) break;
    } else {
      damping *= 4;
      if (damping > 1e12) break;
    }
  }
  return {c.cwiseAbs2().cwiseProduct(scale), r.squaredNorm()};
}

Values coefficients(const Eigen::VectorXd& theta) {
  return {std::sqrt(theta[1]), std::sqrt(theta[2]), std::sqrt(theta[3])};
}

Values relative_fit(const std::vector<double>& y, double rate_hz) {
  return coefficients(relative_nnls(
      logarithmic_points(centred_sums(y), rate_hz, static_cast<double>(y.size()) / 10)));
}

Values imu_utils(const std::vector<double>& y, double rate_hz) {
  const double largest = std::exp2(std::floor(std::log2(static_cast<double>(y.size()) / 2)));
  const Curve curve = logarithmic_points(centred_sums(y), rate_hz, largest);
  const Eigen::VectorXd start = relative_nnls(curve);
  Fitted best;
  for (const double least : {1e-8, 1e-5, 1e-3, 1e-1}) {
    const Fitted fitted = log_least_squares(curve, start, least);
    if (fitted.misfit < best.misfit) best = fitted;
  }
  return coefficients(best.theta);
}

Values ours(const std::vector<double>& y, double rate_hz) {
  const AllanCurve curve = allan_deviation(y, 1 / rate_hz);
  const NoiseFit fit = fit_record(y, rate_hz, &curve);
  return {fit[Term::white].value.value_or(0),
          fit[Term::flicker].value.value_or(0),
          fit[Term::walk].value.value_or(0)};
}

// ---- the comparison ----

struct Method {
  std::string name;
  Values (*estimate)(const std::vector<double>&, double);
};

const std::vector<Method> kMethods = {{"sensorchar", ours},
                                      {"imu_utils", imu_utils},
                                      {"allan_variance_ros", allan_variance_ros},
                                      {"relative NNLS", relative_fit}};

struct Tally {
  Values sum{}, error{};  // error: sum of squares about the truth
  double seconds = 0;
};

std::string cell(const Tally& t, std::size_t k, int n, double truth, double reference) {
  const double rms = std::sqrt(t.error[k] / n), mean = t.sum[k] / n;
  const std::string ratio = reference > 0 ? fmt::format("{:.3g} ×", rms / reference)
                            : rms > 0     ? "–"
                                          : "0";
  return truth > 0 ? fmt::format("{:.4g} ± {:.2g} ({})", mean, rms, ratio)
                   : fmt::format("{:.2g} (absent)", mean);
}

void run_scene(const Scene& scene, std::uint64_t seed, int records) {
  std::vector<Tally> tallies(kMethods.size());
  test::NoiseSource source(scene.samples, scene.rate_hz, seed);
  for (int i = 0; i < records; ++i) {
    const std::vector<double> y = source.record(scene.truth[0], scene.truth[1], scene.truth[2]);
    for (std::size_t k = 0; k < kMethods.size(); ++k) {
      const auto from = Clock::now();
      const Values got = kMethods[k].estimate(y, scene.rate_hz);
      tallies[k].seconds += std::chrono::duration<double>(Clock::now() - from).count();
      for (std::size_t t = 0; t < 3; ++t) {
        tallies[k].sum[t] += got[t];
        tallies[k].error[t] += (got[t] - scene.truth[t]) * (got[t] - scene.truth[t]);
      }
    }
  }
  fmt::print("\n{}: Q {:g}, B {:g}, K {:g}; {} samples at {:g} Hz, {} records\n\n",
             scene.name,
             scene.truth[0],
             scene.truth[1],
             scene.truth[2],
             scene.samples,
             scene.rate_hz,
             records);
  fmt::print("| method | Q | B | K | ms |\n|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < kMethods.size(); ++k) {
    fmt::print("| {} |", kMethods[k].name);
    for (std::size_t t = 0; t < 3; ++t)
      fmt::print(
          " {} |",
          cell(tallies[k], t, records, scene.truth[t], std::sqrt(tallies[0].error[t] / records)));
    fmt::print(" {:.0f} |\n", 1e3 * tallies[k].seconds / records);
  }
}

// ---- published curves ----

void run_curves(const std::filesystem::path& folder) {
  fmt::print(
      "\nrms of log10(model/measured deviation) on the curves that imu_utils published, mean of "
      "three axes:\n\n");
  fmt::print(
      "| IMU | sensor | imu_utils | ours, all terms | ours, decided | worst axis, decided ÷ "
      "imu_utils |\n|---|---|---|---|---|---|\n");
  for (const std::string imu : {"16448", "A3", "BMI160", "N3", "gx4", "xsens"})
    for (const std::string kind : {"acc", "gyr"}) {
      double theirs = 0, all_terms = 0, decided = 0, worst = 0;
      for (const std::string axis : {"x", "y", "z"}) {
        DigitisedCurve curve;
        curve.x = numbers(folder / ("data_" + imu + "_" + kind + "_t.txt"));
        curve.y = numbers(folder / ("data_" + imu + "_" + kind + "_" + axis + ".txt"));
        FitOptions all;
        all.threshold = 0;
        const double t = rms_log10(
            curve.y, numbers(folder / ("data_" + imu + "_sim_" + kind + "_" + axis + ".txt")));
        const double d = rms_log10(fit_curve(curve));
        theirs += t / 3;
        all_terms += rms_log10(fit_curve(curve, all)) / 3;
        decided += d / 3;
        worst = std::max(worst, d / t);
      }
      fmt::print("| {} | {} | {:.4f} | {:.4f} | {:.4f} | {:.3f} |\n",
                 imu,
                 kind,
                 theirs,
                 all_terms,
                 decided,
                 worst);
    }
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 12;
  const std::string wanted = argc > 2 ? argv[2] : "";
  for (std::size_t s = 0; s < kScenes.size(); ++s)
    if (wanted.empty() || wanted.find(static_cast<char>('0' + s)) != std::string::npos)
      run_scene(kScenes[s], 20 + s, records);
  const std::filesystem::path curves = test::shared_folder() / "oracle/allan/imu_utils_mit";
  if (std::filesystem::exists(curves))
    run_curves(curves);
  else
    fmt::print("\nthe curves of imu_utils are not beside this checkout: skipped\n");
}
