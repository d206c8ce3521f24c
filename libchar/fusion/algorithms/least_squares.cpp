#include "libchar/fusion/algorithms/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "libchar/core/dense.hpp"
#include "libchar/core/error.hpp"
#include "libchar/fusion/detail/weighted_mean.hpp"

namespace libchar::fusion {
namespace {

/// A gain below so many of its own standard deviations may as well be zero.
constexpr double kSignificant = 4;

[[noreturn]] void cannot(const std::string& what, const std::string& hint) {
  throw Error({ErrorKind::numeric, "E0856", "", what, "", hint});
}

}  // namespace

WeightLearner::WeightLearner(Eigen::Index channels)
    : n_(channels), triangle_(channels + 2), row_(channels + 2) {}

void WeightLearner::add(const Sample& y, double x) {
  for (Eigen::Index i = 0; i < n_; ++i)
    if (!usable(y[i])) return;
  if (triangle_.rows() == 0) origin_ = x;
  row_[0] = 1;
  row_.segment(1, n_) = y.array() - x;
  row_[n_ + 1] = x - origin_;
  triangle_.add(row_);
}

/// Errors of the corrected channels as combinations of the triangle's columns: e_i = (d_i - alpha -
/// beta x) / a, d = y - x.
Eigen::MatrixXd WeightLearner::calibrate(const Eigen::MatrixXd& upper,
                                         LearntWeights& learnt) const {
  Eigen::MatrixXd a(upper.rows(), 2);
  a << upper.col(0), upper.col(n_ + 1);
  const double moves = a.col(1).tail(a.rows() - 1).norm();
  if (!(moves > 1e-12 * a.col(1).norm()))
    cannot("the reference does not move in the learning window: no gain can be learnt",
           "set calibrate to 0, or learn elsewhere");
  const Eigen::Vector2d length = a.colwise().norm().transpose();
  const Eigen::MatrixXd lines =
      least_squares(a * length.cwiseInverse().asDiagonal(), upper.middleCols(1, n_));
  const double mean_x = origin_ + upper(0, n_ + 1) / upper(0, 0);
  Eigen::MatrixXd error(upper.rows(), n_);
  for (Eigen::Index i = 0; i < n_; ++i) {
    const Eigen::VectorXd d = upper.col(1 + i);
    const Eigen::Vector2d line = (lines.col(i).array() / length.array()).matrix();
    error.col(i) = d - a * line;
    const double gain = 1 + line[1];
    const double deviation =
        error.col(i).norm() /
        std::sqrt(std::max<double>(1, static_cast<double>(triangle_.rows()) - 2)) / moves;
    if (!(std::abs(gain) > kSignificant * deviation) || std::abs(gain) < 1e-9) {
      learnt.without_signal.push_back(static_cast<int>(i));
      continue;
    }
    learnt.gain[i] = gain;
    // The line passes through the means; line[0] belongs to the origin, far from them, and would
    // lose a digit on the way back.
    learnt.bias[i] = upper(0, 1 + i) / upper(0, 0) - line[1] * mean_x;
    error.col(i) /= gain;
  }
  return error;
}

LearntWeights WeightLearner::weights(const LeastSquaresForm& form) {
  const Eigen::MatrixXd& upper = triangle_.upper();
  LearntWeights learnt;
  learnt.gain = Eigen::VectorXd::Ones(n_);
  learnt.bias = learnt.weights = Eigen::VectorXd::Zero(n_);
  if (!enough())
    cannot("the learning window has " + std::to_string(triangle_.rows()) +
               " instants in which every channel has a sample; " + std::to_string(n_ + 2) +
               " are needed for " + std::to_string(n_) + " channels",
           "a longer window, or fewer channels");
  const Eigen::MatrixXd error =
      form.calibrate ? calibrate(upper, learnt) : Eigen::MatrixXd(upper.middleCols(1, n_));
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < n_; ++i)
    if (std::find(learnt.without_signal.begin(), learnt.without_signal.end(), i) ==
        learnt.without_signal.end())
      used.push_back(i);
  if (used.empty()) cannot("no channel follows the reference in the learning window", "");

  // Unknowns: weights (with sum w = 1 all but that of the last channel, by differences to it), then
  // the constant.
  const auto m = static_cast<Eigen::Index>(used.size());
  const Eigen::Index weights = form.sum_to_one ? m - 1 : m,
                     unknowns = weights + (form.constant ? 1 : 0);
  Eigen::MatrixXd problem(upper.rows(), unknowns + 1);
  const Eigen::VectorXd last = error.col(used.back());
  const Eigen::VectorXd truth = upper.col(n_ + 1) + origin_ * upper.col(0);
  for (Eigen::Index k = 0; k < weights; ++k)
    problem.col(k) = form.sum_to_one
                         ? (error.col(used[static_cast<std::size_t>(k)]) - last).eval()
                         : (error.col(used[static_cast<std::size_t>(k)]) + truth).eval();
  if (form.constant) problem.col(weights) = upper.col(0);
  problem.col(unknowns) = form.sum_to_one ? (-last).eval() : truth;
  // What is left of channels that cancel is rounding, not a column to be scaled up.
  const auto size = [&](Eigen::Index i) {
    return upper.col(1 + i).norm() + upper.col(n_ + 1).norm();
  };
  for (Eigen::Index k = 0; k < weights; ++k)
    if (problem.col(k).norm() <=
        1e-14 * (size(used[static_cast<std::size_t>(k)]) + size(used.back())))
      problem.col(k).setZero();
  Eigen::VectorXd solution(unknowns);
  if (unknowns > 0) solution = solve_scaled(problem, unknowns, learnt.dependent);
  for (Eigen::Index k = 0; k < weights; ++k)
    learnt.weights[used[static_cast<std::size_t>(k)]] = solution[k];
  if (form.sum_to_one) learnt.weights[used.back()] = 1 - learnt.weights.sum();
  if (form.constant) learnt.constant = solution[weights];
  const double left = (problem.leftCols(unknowns) * solution - problem.col(unknowns)).squaredNorm();
  learnt.variance =
      left / static_cast<double>(std::max<std::int64_t>(1, triangle_.rows() - unknowns));
  return learnt;
}

void LearntMean::take(const LearntWeights& learnt) {
  learnt_ = learnt;
  direct_ = learnt.weights.cwiseQuotient(learnt.gain);
  total_ = direct_.sum();
  constant_ = learnt.constant - direct_.dot(learnt.bias);
  // The sum of weights over gains is one but for rounding; the input's offset must not see that
  // rounding.
  if ((learnt.gain.array() == 1).all() && std::abs(total_ - 1) < 1e-12) total_ = 1;
}

Estimate LearntMean::step(const Sample& y) const {
  double a = 0;
  const double base = y[0];
  for (Eigen::Index i = 0; i < y.size(); ++i) a += direct_[i] * (y[i] - base);
  const double x = a + total_ * base + constant_;
  return std::abs(x) <= kLargestSample ? Estimate::scalar(x, learnt_.variance) : of_present(y);
}

Estimate LearntMean::of_present(const Sample& y) const {
  double sum = 0, used = 0, even = 0;
  int present = 0;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (!usable(y[i]) || learnt_.weights[i] == 0) continue;
    const double corrected = (y[i] - learnt_.bias[i]) / learnt_.gain[i];
    sum += learnt_.weights[i] * corrected;
    used += learnt_.weights[i];
    even += corrected;
    ++present;
  }
  if (present == 0) return Estimate::none(1);
  const double all = learnt_.weights.sum();
  // Weights may be negative: a small or negative rest is no basis to scale up from.
  const double x = used > 0.05 * all ? sum * (all / used) : even / present;
  return Estimate::scalar(x + learnt_.constant, std::nan(""));
}

template <bool kPublished>
void LeastSquaresOf<kPublished>::remarks(Warnings& warnings) const {
  const LearntWeights& learnt = mean_.learnt();
  for (const int i : learnt.without_signal)
    warnings.add(
        "channel_without_signal",
        std::string(description.name) + " left out a channel that does not follow the reference",
        "channel " + std::to_string(i + 1));
  if (learnt.dependent > 0)
    warnings.add("dependent_channels",
                 std::string(description.name) + " found channels that are combinations of others",
                 {},
                 static_cast<std::uint64_t>(learnt.dependent));
}

template struct LeastSquaresOf<false>;
template struct LeastSquaresOf<true>;

}  // namespace libchar::fusion
