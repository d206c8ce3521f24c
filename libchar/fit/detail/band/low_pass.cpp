// |H|^2 = (1-a)^2 / (1 - 2 a cos w + a^2),  w = 2 pi f / rate,  a = exp(-2 pi corner/rate)
// (an exponential filter of the samples). The corner enters nonlinearly: one-dimensional search over the best
// likelihood of the linear terms (golden section in ln corner after a coarse scan), then Ceres on ln theta and ln
// corner together for the last digits and the joint covariance.
#include "libchar/fit/detail/band/low_pass.hpp"

#include <ceres/ceres.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/process/silent_glog.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/curve/ceres_options.hpp"

namespace libchar {
namespace {

class LowPassResiduals final : public ceres::CostFunction {
 public:
  LowPassResiduals(const std::vector<PowerBin>& bins, double rate_hz, std::vector<std::size_t> terms)
      : bins_(bins), rate_hz_(rate_hz), terms_(std::move(terms)) {
    set_num_residuals(static_cast<int>(bins.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(terms_.size() + 1));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::size_t p = terms_.size();
    const double corner_hz = std::exp(parameters[0][p]);
    for (std::size_t j = 0; j < bins_.size(); ++j) {
      const LowPassGain low_pass = low_pass_gain(bins_[j], corner_hz, rate_hz_);
      std::array<double, kTerms> part{};
      double model = 0;
      for (std::size_t i = 0; i < p; ++i) {
        part[i] = std::exp(parameters[0][i]) * bins_[j].unit[terms_[i]] * low_pass.gain;
        model += part[i];
      }
      if (!(model > 0) || !std::isfinite(model)) return false;
      const DevianceResidual r = deviance_residual(bins_[j].energy, model, bins_[j].dof);
      if (!std::isfinite(r.value) || !std::isfinite(r.slope * low_pass.log_slope)) return false;
      residuals[j] = r.value;
      if (jacobians == nullptr || jacobians[0] == nullptr) continue;
      double* row = jacobians[0] + j * (p + 1);
      for (std::size_t i = 0; i < p; ++i) row[i] = r.slope * part[i] / model;
      row[p] = r.slope * low_pass.log_slope;
    }
    return true;
  }

 private:
  const std::vector<PowerBin>& bins_;
  double rate_hz_;
  std::vector<std::size_t> terms_;
};

ScoringResult scored(const std::vector<PowerBin>& bins, double corner_hz, double rate_hz, const TermSet& terms) {
  return score(bin_problem(low_passed(bins, corner_hz, rate_hz)), terms, nullptr, 1e-8);
}

/// ln corner of least deviance: coarse scan of 24 points, then golden section.
double best_log_corner(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms) {
  const auto cost = [&](double log_corner) { return scored(bins, std::exp(log_corner), rate_hz, terms).half_deviance; };
  const double first = std::log(1e-3 * rate_hz), last = std::log(2 * rate_hz), step = (last - first) / 23;
  double best = first, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 24; ++i) {
    const double value = cost(first + step * i);
    if (value < least) {
      least = value;
      best = first + step * i;
    }
  }
  constexpr double kGolden = 0.6180339887498949;
  double low = best - step, high = best + step;
  double x1 = high - kGolden * (high - low), x2 = low + kGolden * (high - low);
  double f1 = cost(x1), f2 = cost(x2);
  while (high - low > 1e-4) {
    if (f1 < f2) {
      high = x2;
      x2 = x1;
      f2 = f1;
      f1 = cost(x1 = high - kGolden * (high - low));
    } else {
      low = x1;
      x1 = x2;
      f1 = f2;
      f2 = cost(x2 = low + kGolden * (high - low));
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

LowPassGain low_pass_gain(double frequency_hz, double corner_hz, double rate_hz) {
  const double exponent = 2 * std::numbers::pi * corner_hz / rate_hz;
  const double a = std::exp(-exponent), pass = -std::expm1(-exponent);
  const double half_sine = std::sin(std::numbers::pi * frequency_hz / rate_hz);
  const double below = pass * pass + 4 * a * half_sine * half_sine;  // 1 - 2 a cos w + a^2 without cancellation
  // d ln gain/da = -2/(1-a) - (2a - 2 cos w)/below, da/dln corner = -exponent a
  const double cosine = 1 - 2 * half_sine * half_sine;
  return {pass * pass / below, exponent * a * (2 / pass + 2 * (a - cosine) / below)};
}

LowPassGain low_pass_gain(const PowerBin& bin, double corner_hz, double rate_hz) {
  constexpr int kNodes = 5;
  LowPassGain mean{0, 0};
  for (int i = 0; i < kNodes; ++i) {
    const double f = bin.low_hz + (bin.high_hz - bin.low_hz) * (i + 0.5) / kNodes;
    const LowPassGain at = low_pass_gain(std::min(f, rate_hz / 2), corner_hz, rate_hz);
    mean.gain += at.gain / kNodes;
    mean.log_slope += at.gain * at.log_slope / kNodes;
  }
  mean.log_slope /= mean.gain;
  return mean;
}

std::vector<PowerBin> low_passed(std::vector<PowerBin> bins, double corner_hz, double rate_hz) {
  for (PowerBin& bin : bins) {
    const double gain = low_pass_gain(bin, corner_hz, rate_hz).gain;
    for (double& unit : bin.unit) unit *= gain;
  }
  return bins;
}

std::optional<LowPassFit> fit_low_pass(const std::vector<PowerBin>& bins, double rate_hz,
                                       const std::array<bool, kTerms>& offered) {
  const SilentGlog silent;
  const double log_corner = best_log_corner(bins, rate_hz, offered);
  const ScoringResult start = scored(bins, std::exp(log_corner), rate_hz, offered);
  std::vector<std::size_t> terms;
  std::vector<double> x;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!(start.at.theta[i] > 0)) continue;
    terms.push_back(i);
    x.push_back(std::log(start.at.theta[i]));
  }
  if (terms.empty()) return std::nullopt;
  x.push_back(log_corner);
  ceres::Problem problem;
  problem.AddResidualBlock(new LowPassResiduals(bins, rate_hz, terms), nullptr, x.data());
  ceres::Solver::Summary summary;
  count_work(WorkKind::descents, 1);
  ceres::Solve(exact_solver_options(200), &problem, &summary);
  if (!has_covariance(problem)) return std::nullopt;

  LowPassFit fit;
  fit.corner_hz = std::exp(x.back());
  // Below all bins the slope of a walk, and no corner: N would be of a frequency that nobody has seen.
  if (!(fit.corner_hz > bins.front().high_hz)) return std::nullopt;
  fit.half_deviance = summary.final_cost;
  for (std::size_t i = 0; i < terms.size(); ++i) fit.theta[terms[i]] = std::exp(x[i]);
  ceres::Covariance covariance(exact_covariance_options());
  const std::vector<std::pair<const double*, const double*>> wanted = {{x.data(), x.data()}};
  std::vector<double> block(x.size() * x.size());
  if (!covariance.Compute(wanted, &problem) || !covariance.GetCovarianceBlock(x.data(), x.data(), block.data()))
    return std::nullopt;
  for (std::size_t i = 0; i < terms.size(); ++i) fit.log_theta_sd[terms[i]] = std::sqrt(block[i * (x.size() + 1)]);
  fit.log_sd = std::sqrt(block.back());
  return fit;
}

}  // namespace libchar
