// Asymptotes that these recipes assume of the Allan variance at tau, per squared coefficient (IEEE Std 952-1997, annex
// C): 3/tau^2 quantization, 1/tau white, 2 ln 2/pi flicker, tau/3 walk, tau^2/2 ramp.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/benchmark/detail/estimators.hpp"
#include "libchar/core/numeric/whole.hpp"

namespace libchar {
namespace {

struct Variances {
  std::vector<double> tau, variance;
  std::size_t size() const { return tau.size(); }
};

constexpr double kFlicker = 2 * std::numbers::ln2 / std::numbers::pi;
constexpr int kAsymptotes = 5;
using Asymptotes = Eigen::Matrix<double, 1, kAsymptotes>;
using Chosen = std::array<bool, kAsymptotes>;

Asymptotes asymptotes(double tau) { return {3 / (tau * tau), 1 / tau, kFlicker, tau / 3, tau * tau / 2}; }

std::vector<double> centred_sums(std::span<const double> y) {
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
  const auto length = static_cast<double>(m);
  return terms == 0 ? 0 : sum / (2 * static_cast<double>(terms) * length * length);
}

Variances logarithmic_points(std::span<const double> y, double rate_hz, double largest) {
  const std::vector<double> sums = centred_sums(y);
  Variances curve;
  std::size_t last = 0;
  for (int i = 0; i < 100; ++i) {
    const auto m = clamped_whole<std::size_t>(std::pow(largest, i / 99.0));
    if (m == last || 2 * m + 1 >= sums.size()) continue;
    last = m;
    const double variance = allan_variance_of(sums, m, 1);
    if (!(variance > 0)) continue;
    curve.tau.push_back(static_cast<double>(m) / rate_hz);
    curve.variance.push_back(variance);
  }
  return curve;
}

Variances linear_periods(std::span<const double> y, double rate_hz) {
  const std::vector<double> sums = centred_sums(y);
  Variances curve;
  for (int period = 1; period < 10000; ++period) {
    const auto m = clamped_whole<std::size_t>(std::round(0.1 * period * rate_hz));
    if (m == 0) continue;
    if (sums.size() < 4 * m) break;
    const double variance = allan_variance_of(sums, m, m);
    if (!(variance > 0)) continue;
    curve.tau.push_back(static_cast<double>(m) / rate_hz);
    curve.variance.push_back(variance);
  }
  return curve;
}

Variances tenth_of(std::span<const double> y, double rate_hz) {
  return logarithmic_points(y, rate_hz, static_cast<double>(y.size()) / 10);
}

/// Sum of (sum theta u / v - 1)^2 over theta >= 0: of all subsets the best whose solution is not negative.
Eigen::VectorXd relative_nnls(const Variances& curve) {
  const auto n = static_cast<Eigen::Index>(curve.size());
  Eigen::MatrixXd a(n, kAsymptotes);
  for (Eigen::Index i = 0; i < n; ++i)
    a.row(i) = asymptotes(curve.tau[static_cast<std::size_t>(i)]) / curve.variance[static_cast<std::size_t>(i)];
  Eigen::VectorXd best = Eigen::VectorXd::Zero(kAsymptotes);
  double lowest = static_cast<double>(n);
  for (unsigned subset = 1; subset < 1U << unsigned{kAsymptotes}; ++subset) {
    std::vector<Eigen::Index> columns;
    for (Eigen::Index c = 0; c < kAsymptotes; ++c)
      if ((subset >> static_cast<unsigned>(c) & 1U) != 0) columns.push_back(c);
    Eigen::MatrixXd part = a(Eigen::indexing::all, columns);
    const Eigen::RowVectorXd scale = part.colwise().norm();
    part.array().rowwise() /= scale.array();
    const Eigen::VectorXd x = part.colPivHouseholderQr().solve(Eigen::VectorXd::Ones(n));
    const double misfit = (part * x - Eigen::VectorXd::Ones(n)).squaredNorm();
    if (x.minCoeff() < 0 || misfit >= lowest) continue;
    lowest = misfit;
    best.setZero();
    for (std::size_t c = 0; c < columns.size(); ++c)
      best[columns[c]] = x[static_cast<Eigen::Index>(c)] / scale[static_cast<Eigen::Index>(c)];
  }
  return best;
}

/// log10 of model over measured variance; unknowns are square roots, so that no variance is negative.
class LogResiduals {
 public:
  LogResiduals(const Variances& curve, const Chosen& chosen) : curve_(curve), chosen_(chosen) {
    const auto n = static_cast<Eigen::Index>(curve.size());
    unit_.resize(n, kAsymptotes);
    for (Eigen::Index i = 0; i < n; ++i) unit_.row(i) = asymptotes(curve.tau[static_cast<std::size_t>(i)]);
    // Scaled so that each at 1 makes the whole variance somewhere.
    for (Eigen::Index c = 0; c < kAsymptotes; ++c) {
      double least = std::numeric_limits<double>::infinity();
      for (Eigen::Index i = 0; i < n; ++i)
        least = std::min(least, curve.variance[static_cast<std::size_t>(i)] / unit_(i, c));
      unit_.col(c) *= chosen_[static_cast<std::size_t>(c)] ? least : 0;
      scale_[c] = least;
    }
  }

  /// Of squared coefficients; absent ones begin with `least` of the variance: at zero they would stay there.
  Eigen::VectorXd start(const Eigen::VectorXd& theta, double least) const {
    Eigen::VectorXd c = theta.cwiseQuotient(scale_).cwiseMax(least).cwiseSqrt();
    for (Eigen::Index i = 0; i < kAsymptotes; ++i)
      if (!chosen_[static_cast<std::size_t>(i)]) c[i] = 0;
    return c;
  }
  Eigen::VectorXd theta(const Eigen::VectorXd& at) const { return at.cwiseAbs2().cwiseProduct(scale_); }
  Eigen::VectorXd at(const Eigen::VectorXd& c, Eigen::MatrixXd* jacobian) const {
    Eigen::VectorXd r(unit_.rows());
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const double model = unit_.row(i) * c.cwiseAbs2();
      r[i] = std::log10(model / curve_.variance[static_cast<std::size_t>(i)]);
      if (jacobian != nullptr)
        jacobian->row(i) = (2 / (model * std::numbers::ln10)) * unit_.row(i).cwiseProduct(c.transpose());
    }
    return r;
  }

 private:
  const Variances& curve_;
  Chosen chosen_;
  Eigen::MatrixXd unit_;
  Eigen::Matrix<double, kAsymptotes, 1> scale_;
};

struct Fitted {
  Eigen::VectorXd theta;
  double misfit = std::numeric_limits<double>::infinity();
};

/// Levenberg and Marquardt.
Fitted log_least_squares(const LogResiduals& residuals, Eigen::VectorXd c) {
  double damping = 1e-3;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(residuals.at(c, nullptr).size(), kAsymptotes);
  Eigen::VectorXd r = residuals.at(c, &jacobian);
  for (int iteration = 0; iteration < 200 && damping < 1e12; ++iteration) {
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    Eigen::MatrixXd damped = normal;
    damped.diagonal() += damping * (normal.diagonal().array() + 1e-12).matrix();
    const Eigen::VectorXd next = c - damped.colPivHouseholderQr().solve(jacobian.transpose() * r);
    const Eigen::VectorXd tried = residuals.at(next, nullptr);
    if (!(tried.squaredNorm() < r.squaredNorm())) {
      damping *= 4;
      continue;
    }
    const bool done = r.squaredNorm() - tried.squaredNorm() < 1e-14 * r.squaredNorm();
    c = next;
    r = residuals.at(c, &jacobian);
    damping *= 0.3;
    if (done) break;
  }
  return {residuals.theta(c), r.squaredNorm()};
}

Fitted best_log_fit(const Variances& curve, const Chosen& chosen) {
  const LogResiduals residuals(curve, chosen);
  const Eigen::VectorXd start = relative_nnls(curve);
  Fitted best;
  for (const double least : {1e-8, 1e-5, 1e-3, 1e-1}) {
    Fitted fitted = log_least_squares(residuals, residuals.start(start, least));
    if (fitted.misfit < best.misfit) best = std::move(fitted);
  }
  return best;
}

void set_value(NoiseEstimate& estimate, Term term, double value) {
  estimate[static_cast<std::size_t>(term)].value = value;
}

NoiseEstimate three_terms(double white, double flicker, double walk) {
  NoiseEstimate out;
  set_value(out, Term::white, white);
  set_value(out, Term::flicker, flicker);
  set_value(out, Term::walk, walk);
  return out;
}

NoiseEstimate estimate_from(const Eigen::VectorXd& theta) {
  return three_terms(std::sqrt(theta[1]), std::sqrt(theta[2]), std::sqrt(theta[3]));
}

/// Slope of ln sigma over ln tau between a point and the next.
double slope_at(const Variances& curve, std::size_t i) {
  return 0.5 * std::log(curve.variance[i + 1] / curve.variance[i]) / std::log(curve.tau[i + 1] / curve.tau[i]);
}

/// The point whose slope to the next is nearest to `slope`.
std::size_t nearest_slope(const Variances& curve, double slope) {
  std::size_t best = 0;
  for (std::size_t i = 1; i + 1 < curve.size(); ++i)
    if (std::abs(slope_at(curve, i) - slope) < std::abs(slope_at(curve, best) - slope)) best = i;
  return best;
}

}  // namespace

NoiseEstimate read_off(std::span<const double> record, double rate_hz, const TermSet&) {
  const Variances curve = tenth_of(record, rate_hz);
  if (curve.size() < 3) return {};
  const std::size_t falling = nearest_slope(curve, -0.5), rising = nearest_slope(curve, 0.5);
  const double lowest = *std::min_element(curve.variance.begin(), curve.variance.end());
  return three_terms(std::sqrt(curve.variance[falling] * curve.tau[falling]), std::sqrt(lowest / kFlicker),
                     std::sqrt(3 * curve.variance[rising] / curve.tau[rising]));
}

NoiseEstimate log_log(std::span<const double> record, double rate_hz, const TermSet&) {
  const Variances curve = tenth_of(record, rate_hz);
  if (curve.size() < 3) return {};
  return estimate_from(best_log_fit(curve, {false, true, true, true, false}).theta);
}

NoiseEstimate relative_least_squares(std::span<const double> record, double rate_hz, const TermSet&) {
  const Variances curve = tenth_of(record, rate_hz);
  if (curve.size() < std::size_t{kAsymptotes}) return {};
  return estimate_from(relative_nnls(curve));
}

NoiseEstimate imu_utils(std::span<const double> record, double rate_hz, const TermSet&) {
  const double half = static_cast<double>(record.size()) / 2;
  const Variances curve = logarithmic_points(record, rate_hz, std::exp2(std::floor(std::log2(half))));
  if (curve.size() < std::size_t{kAsymptotes}) return {};
  return estimate_from(best_log_fit(curve, {true, true, true, true, true}).theta);
}

NoiseEstimate allan_variance_ros(std::span<const double> record, double rate_hz, const TermSet&) {
  const Variances curve = linear_periods(record, rate_hz);
  if (curve.size() < 3) return {};
  double white = 0, walk = 0;
  int short_ones = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double log_sd = 0.5 * std::log(curve.variance[i]), half = 0.5 * std::log(curve.tau[i]);
    if (curve.tau[i] < 10) white += log_sd + half, ++short_ones;
    walk += log_sd - half;
  }
  const double lowest = *std::min_element(curve.variance.begin(), curve.variance.end());
  return three_terms(std::exp(white / short_ones), std::sqrt(lowest),
                     std::sqrt(3.0) * std::exp(walk / static_cast<double>(curve.size())));
}

}  // namespace libchar
