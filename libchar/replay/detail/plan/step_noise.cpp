#include "libchar/replay/detail/plan/step_noise.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fusion/algorithm.hpp"

namespace libchar {
namespace {

constexpr std::int64_t kStretchesOfNoise = 32;
/// Pairs of instants in a stretch, at least.
constexpr std::int64_t kPairsInStretch = 16;
constexpr double kBeyondDoubt = 6;
constexpr double kWorthSaying = 1.25;  // of deviations

double median_of_stretches(std::vector<double> values) { return median_in_place(values, Middle::upper); }

/// Beyond, what grows with the cube of the number of sensors is done in closed form.
constexpr Eigen::Index kManySensors = 64;

std::optional<StepNoise> typical(const std::vector<double>& logs) {
  StepNoise out;
  out.log_variance = median_of_stretches(logs);
  if (!std::isfinite(out.log_variance)) return std::nullopt;
  std::vector<double> off;
  off.reserve(logs.size());
  for (const double value : logs) off.push_back(std::abs(value - out.log_variance));
  const double deviation = kMadToSd * median_of_stretches(off);
  out.error = kMedianError * deviation / std::sqrt(static_cast<double>(logs.size()));
  if (!std::isfinite(out.error)) return std::nullopt;
  return out;
}

}  // namespace

StepNoiseMeter::StepNoiseMeter(const Eigen::MatrixXd& h, std::int64_t instants)
    : one_input_alike_(h.cols() == 1 && (h.array() == 1).all()),
      many_alike_(one_input_alike_ && h.rows() > kManySensors),
      each_(std::max(instants / 2 / kStretchesOfNoise, kPairsInStretch)),
      squares_(Eigen::VectorXd::Zero(h.rows())) {
  const Eigen::Index n = h.rows();
  trace_ = static_cast<double>(n - 1);
  if (many_alike_) return;
  residual_ = complement_projector(column_basis(h));
  trace_ = residual_.trace();
  const Eigen::MatrixXd information = residual_.cwiseProduct(residual_);
  if (n > 0 && symmetric_eigen(information).values[0] > 1e-9)
    inverse_ = general_solve(information, Eigen::MatrixXd::Identity(n, n));
}

void StepNoiseMeter::push(const Eigen::MatrixXd& samples) {
  for (Eigen::Index k = 0; k < samples.cols(); ++k, ++now_) {
    const bool complete = (samples.col(k).array().abs() <= fusion::kLargestSample).all();  // NaN fails
    if (now_ % 2 == 0) {
      has_last_ = complete;
      if (complete) last_ = samples.col(k);
      continue;
    }
    if (!complete || !has_last_) continue;
    e_ = samples.col(k) - last_;
    if (one_input_alike_)
      e_.array() -= e_.mean();
    else
      e_ = (residual_ * e_).eval();
    squares_ += 0.5 * e_.cwiseAbs2();
    if (++pairs_ == each_) close();
  }
}

Eigen::VectorXd StepNoiseMeter::solved(const Eigen::VectorXd& squares) const {
  if (many_alike_) {
    // M = I - 11'/n, so M o M = (1 - 2/n) I + 11'/n^2, and its inverse by Sherman and Morrison:
    const auto n = static_cast<double>(squares.size());
    return (squares.array() - squares.sum() / (n * (n - 1))) / (1 - 2 / n);
  }
  if (inverse_) return *inverse_ * squares;
  return Eigen::VectorXd::Constant(squares.size(), squares.sum() / trace_);
}

void StepNoiseMeter::close() {
  // Twice as many as were expected: two stretches become one of twice the length.
  stretches_.push_back(solved(squares_ / static_cast<double>(pairs_)));
  squares_.setZero();
  pairs_ = 0;
  if (std::ssize(stretches_) < 2 * kStretchesOfNoise) return;
  for (std::size_t s = 0; s < kStretchesOfNoise; ++s) stretches_[s] = 0.5 * (stretches_[2 * s] + stretches_[2 * s + 1]);
  stretches_.resize(kStretchesOfNoise);
  each_ *= 2;
}

std::vector<std::optional<StepNoise>> StepNoiseMeter::result() const {
  if (std::ssize(stretches_) < kStretchesOfNoise / 2 || !(trace_ > 1e-9)) return {};
  std::vector<std::optional<StepNoise>> out;
  for (Eigen::Index i = 0; i < squares_.size(); ++i) {
    std::vector<double> logs;
    for (const Eigen::VectorXd& v : stretches_)
      logs.push_back(v[i] > 0 ? std::log(v[i]) : -std::numeric_limits<double>::infinity());
    out.push_back(typical(logs));
  }
  return out;
}

void warn_of_noise(const std::vector<std::string>& names, const std::vector<std::optional<StepNoise>>& learnt,
                   const std::vector<std::optional<StepNoise>>& here, Findings& warnings) {
  std::vector<std::pair<std::size_t, double>> changes;  // ln of the ratio of deviations
  std::size_t compared = 0;
  double low = 0, high = 0;
  for (std::size_t i = 0; i < std::min(learnt.size(), here.size()); ++i) {
    if (!learnt[i] || !here[i]) continue;
    const double change = here[i]->log_variance - learnt[i]->log_variance;
    low = compared == 0 ? change / 2 : std::min(low, change / 2);
    high = compared == 0 ? change / 2 : std::max(high, change / 2);
    ++compared;
    if (std::abs(change) > kBeyondDoubt * std::hypot(here[i]->error, learnt[i]->error) &&
        std::abs(change) > 2 * std::log(kWorthSaying))
      changes.emplace_back(i, change / 2);
  }
  const auto times = [](double log_ratio) { return brief_text(std::exp(log_ratio), 2); };
  if (compared > 1 && changes.size() == compared && high - low < std::log(kWorthSaying)) {
    warnings.add("noise_changed_of_all",
                 "all sensors scatter from sample to sample as they did not where this was learnt: weights of there "
                 "fit, standard deviations do not",
                 fmt::format("{} times", times(0.5 * (low + high))));
    return;
  }
  for (const auto& [i, change] : changes)
    warnings.add("noise_changed",
                 "sensors scatter from sample to sample as they did not where this was learnt: weights and standard "
                 "deviations of there may not fit",
                 fmt::format("{} is {} times as noisy", printable(names[i], 40), times(change)));
}

}  // namespace libchar
