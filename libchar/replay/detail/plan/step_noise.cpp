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
constexpr double kWorthSaying = 1.25;     // of deviations
constexpr std::size_t kLeastOfSplit = 8;  // stretches before and behind it
constexpr double kSplitBeyondDoubt = 9;   // standard errors, at the place that explains most
constexpr double kSplitTimes = 1.5;       // of deviations

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
    moves_ += e_.mean() * e_.mean();
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
  Eigen::VectorXd all(squares_.size() + 1);
  all << solved(squares_ / static_cast<double>(pairs_)), moves_ / static_cast<double>(pairs_);
  stretches_.push_back(std::move(all));
  ends_.push_back(now_ + 1);
  squares_.setZero();
  pairs_ = 0;
  moves_ = 0;
  if (std::ssize(stretches_) < 2 * kStretchesOfNoise) return;
  for (std::size_t s = 0; s < kStretchesOfNoise; ++s) {
    stretches_[s] = 0.5 * (stretches_[2 * s] + stretches_[2 * s + 1]);
    ends_[s] = ends_[2 * s + 1];
  }
  stretches_.resize(kStretchesOfNoise);
  ends_.resize(kStretchesOfNoise);
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

StepNoiseMeter::Split StepNoiseMeter::split(Eigen::Index row, std::size_t at) const {
  std::vector<double> parts[2], off;
  for (std::size_t s = 0; s < stretches_.size(); ++s) parts[s < at ? 0 : 1].push_back(stretches_[s][row]);
  const auto n = static_cast<double>(parts[0].size()), m = static_cast<double>(parts[1].size());
  Split out{median_of_stretches(parts[0]), median_of_stretches(parts[1])};
  double variance = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    off.clear();
    for (const double value : parts[k]) off.push_back(std::abs(value - (k == 0 ? out.before : out.behind)));
    const double deviation = kMedianError * kMadToSd * median_of_stretches(off);
    variance += deviation * deviation / (k == 0 ? n : m);
  }
  out.error = std::sqrt(variance);
  out.beyond = out.error > 0 ? std::abs(out.behind - out.before) / out.error : 0;
  return out;
}

/// Stretches before the step that explains most of the squares about the mean.
std::size_t StepNoiseMeter::step_place(Eigen::Index row) const {
  const std::size_t n = stretches_.size();
  double all = 0, sum = 0, most = -1;
  for (const Eigen::VectorXd& one : stretches_) all += one[row];
  std::size_t out = 0;
  for (std::size_t at = 1; at + kLeastOfSplit <= n; ++at) {
    sum += stretches_[at - 1][row];
    const auto before = static_cast<double>(at), behind = static_cast<double>(n - at);
    const double step = (all - sum) / behind - sum / before, explained = step * step * before * behind;
    if (at >= kLeastOfSplit && explained > most) most = explained, out = at;
  }
  return out;
}

std::vector<StepNoiseMeter::Change> StepNoiseMeter::changes() const {
  std::vector<Change> out;
  if (std::ssize(stretches_) < kStretchesOfNoise / 2 || !identifiable()) return out;
  const Eigen::Index n = squares_.size();
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t place = step_place(i);
    const Split most = split(i, place);
    if (most.beyond < kSplitBeyondDoubt) continue;
    const double resolved = 2 * most.error;
    const bool least = std::min(most.before, most.behind) < resolved;
    const double ratio = std::max(most.behind, resolved) / std::max(most.before, resolved);
    const Split motion = split(n, place);
    const double moves = motion.before > 0 ? motion.behind / motion.before : 1;
    if (std::max(ratio, 1 / ratio) > kSplitTimes * kSplitTimes * std::max({1.0, moves, 1 / moves}))
      out.push_back({static_cast<std::size_t>(i), std::sqrt(ratio), least, ends_[place - 1]});
  }
  if (2 * std::ssize(out) > n) out.clear();  // it is what they see that changes
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
