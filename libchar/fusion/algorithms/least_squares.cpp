#include "libchar/fusion/algorithms/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fusion/detail/variances/error_weights.hpp"
#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {

Triangle::Triangle(Eigen::Index width) : upper_(Eigen::MatrixXd::Zero(width, width)), pending_(3 * width + 8, width) {}

void Triangle::add(const Eigen::VectorXd& row) {
  pending_.row(filled_++) = row.transpose();
  ++rows_;
  if (filled_ == pending_.rows()) fold();
}

void Triangle::fold() {
  if (filled_ == 0) return;
  Eigen::MatrixXd stacked(upper_.rows() + filled_, upper_.cols());
  stacked << upper_, pending_.topRows(filled_);
  upper_ = qr_triangle(stacked);
  filled_ = 0;
}

const Eigen::MatrixXd& Triangle::upper() {
  fold();
  return upper_;
}

namespace {

/// Rounding of a column of a triangle of so many rows, relative to the column's length: errors of
/// the folds add up as steps of a random walk do.
double rounding_of_rows(std::int64_t rows) {
  constexpr double kSteps = 32;  // tried with five columns of 2e3 to 2e5 rows
  return kSteps * std::numeric_limits<double>::epsilon() *
         std::sqrt(static_cast<double>(std::max<std::int64_t>(rows, 1)));
}

/// argmin |A w - b| from the triangle of rows [A b]: columns scaled to length one, then QR with
/// pivoting; the shortest w where several do as well. Columns count as dependent when less than
/// `rounding` of them is left beside the others; `dependent` receives their number.
Eigen::VectorXd solve_scaled(const Eigen::MatrixXd& upper, Eigen::Index unknowns, double rounding,
                             Eigen::Index& dependent) {
  Eigen::VectorXd length = upper.leftCols(unknowns).colwise().norm().transpose();
  for (double& l : length)
    if (!(l > 0)) l = 1;
  const Eigen::MatrixXd a = upper.leftCols(unknowns) * length.cwiseInverse().asDiagonal();
  const PivotedSolution scaled = shortest_least_squares(a, upper.col(unknowns), rounding);
  dependent = unknowns - scaled.rank;
  return (scaled.x.array() / length.array()).matrix();
}

/// A gain below so many of its own standard deviations may as well be zero.
constexpr double kSignificant = 4;

}  // namespace

WeightLearner::WeightLearner(Eigen::Index channels) : n_(channels), triangle_(channels + 2), row_(channels + 2) {}

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
Eigen::MatrixXd WeightLearner::calibrate(const Eigen::MatrixXd& upper, LearntWeights& learnt) const {
  Eigen::MatrixXd a(upper.rows(), 2);
  a << upper.col(0), upper.col(n_ + 1);
  const double moves = a.col(1).tail(a.rows() - 1).norm();
  if (!(moves > 1e-12 * a.col(1).norm()))
    throw numeric_error("E0856")
        .says("the reference does not move in the learning window: no gain can be learnt")
        .hint("set calibrate to 0, or learn elsewhere");
  const Eigen::Vector2d length = a.colwise().norm().transpose();
  const Eigen::MatrixXd lines = least_squares(a * length.cwiseInverse().asDiagonal(), upper.middleCols(1, n_));
  const double mean_x = origin_ + upper(0, n_ + 1) / upper(0, 0);
  Eigen::MatrixXd error(upper.rows(), n_);
  for (Eigen::Index i = 0; i < n_; ++i) {
    const Eigen::VectorXd d = upper.col(1 + i);
    const Eigen::Vector2d line = (lines.col(i).array() / length.array()).matrix();
    error.col(i) = d - a * line;
    const double gain = 1 + line[1];
    const double deviation =
        error.col(i).norm() / std::sqrt(std::max<double>(1, static_cast<double>(triangle_.rows()) - 2)) / moves;
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

/// Lengths of a corrected channel's columns: what its rounding is relative to.
Eigen::VectorXd WeightLearner::column_lengths(const Eigen::MatrixXd& upper, const LearntWeights& learnt) const {
  const double truth = upper.col(n_ + 1).norm();
  Eigen::VectorXd out(n_);
  for (Eigen::Index i = 0; i < n_; ++i) out[i] = upper.col(1 + i).norm() + std::abs(learnt.gain[i] - 1) * truth;
  return out;
}

/// Channels that follow the reference and are no copies of others.
std::vector<Eigen::Index> WeightLearner::originals(const Eigen::MatrixXd& error, const Eigen::VectorXd& truth,
                                                   LearntWeights& learnt) const {
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < n_; ++i)
    if (std::find(learnt.without_signal.begin(), learnt.without_signal.end(), i) == learnt.without_signal.end())
      used.push_back(i);
  if (used.empty()) throw numeric_error("E0856").says("no channel follows the reference in the learning window");
  const Eigen::MatrixXd own = error(Eigen::indexing::all, used);
  for (const auto& [copy, original] : copies_of(own, own.colwise() + truth, rounding_of_rows(triangle_.rows())))
    learnt.copies.emplace_back(static_cast<int>(used[static_cast<std::size_t>(copy)]),
                               static_cast<int>(used[static_cast<std::size_t>(original)]));
  std::erase_if(used, [&](Eigen::Index i) {
    return std::any_of(learnt.copies.begin(), learnt.copies.end(), [i](const auto& pair) { return pair.first == i; });
  });
  return used;
}

/// Unknowns: weights (with sum w = 1 all but that of the last channel, by differences to it), then
/// the constant. `lengths` of the channels used.
void WeightLearner::solve(const LeastSquaresForm& form, const Rows& rows, const std::vector<Eigen::Index>& used,
                          const Eigen::VectorXd& lengths, LearntWeights& learnt) const {
  const auto m = static_cast<Eigen::Index>(used.size());
  const Eigen::Index weights = form.sum_to_one ? m - 1 : m, unknowns = weights + (form.constant ? 1 : 0);
  Eigen::MatrixXd problem(rows.error.rows(), unknowns + 1);
  const Eigen::VectorXd last = rows.error.col(m - 1);
  if (form.sum_to_one)
    problem.leftCols(weights) = rows.error.leftCols(weights).colwise() - last;
  else
    problem.leftCols(weights) = rows.error.colwise() + rows.truth;
  if (form.constant) problem.col(weights) = rows.one;
  problem.col(unknowns) = form.sum_to_one ? (-last).eval() : rows.truth;
  // What is left of channels that cancel is rounding, not a column to be scaled up; and where most
  // of two channels cancels, the rounding is a larger share of what is left.
  double rounding = rounding_of_rows(triangle_.rows());
  const double unit = rounding;
  for (Eigen::Index k = 0; k < weights; ++k) {
    const double size = lengths[k] + (form.sum_to_one ? lengths[m - 1] : rows.truth.norm()),
                 left = problem.col(k).norm();
    if (left <= 100 * unit * size)
      problem.col(k).setZero();
    else
      rounding = std::max(rounding, unit * size / left);
  }
  Eigen::VectorXd solution(unknowns);
  if (unknowns > 0) solution = solve_scaled(problem, unknowns, rounding, learnt.dependent);
  for (Eigen::Index k = 0; k < weights; ++k) learnt.weights[used[static_cast<std::size_t>(k)]] = solution[k];
  if (form.sum_to_one) learnt.weights[used.back()] = 1 - learnt.weights.sum();
  if (form.constant) learnt.constant = solution[weights];
  const double left = (problem.leftCols(unknowns) * solution - problem.col(unknowns)).squaredNorm();
  learnt.variance = left / static_cast<double>(std::max<std::int64_t>(1, triangle_.rows() - unknowns));
}

/// Sum one, from the errors alone: shrunk towards independent errors, or without negative weights.
void WeightLearner::solve_regularized(const LeastSquaresForm& form, const Eigen::MatrixXd& error,
                                      const std::vector<Eigen::Index>& used, const Eigen::VectorXd& lengths,
                                      LearntWeights& learnt) const {
  if (form.non_negative) {
    learnt.weights(used) = non_negative_weights(error);
  } else {
    const double share = form.shrinkage < 0 ? estimated_shrinkage(error, triangle_.rows()) : form.shrinkage;
    const Rows rows{shrunk(error, share), {}, {}};
    solve({.sum_to_one = true}, rows, used, std::sqrt(1 - share) * lengths, learnt);
  }
  const Eigen::VectorXd weights = learnt.weights(used);
  learnt.variance =
      (error * weights).squaredNorm() /
      static_cast<double>(std::max<std::int64_t>(1, triangle_.rows() - static_cast<std::int64_t>(used.size()) + 1));
}

LearntWeights WeightLearner::weights(const LeastSquaresForm& form) {
  const Eigen::MatrixXd& upper = triangle_.upper();
  LearntWeights learnt;
  learnt.gain = Eigen::VectorXd::Ones(n_);
  learnt.bias = learnt.weights = Eigen::VectorXd::Zero(n_);
  if (!enough())
    throw numeric_error("E0856")
        .says("the learning window has " + std::to_string(triangle_.rows()) +
              " instants in which every channel has a sample; " + std::to_string(n_ + 2) + " are needed for " +
              std::to_string(n_) + " channels")
        .hint("a longer window, or fewer channels");
  const Eigen::MatrixXd error = form.calibrate ? calibrate(upper, learnt) : Eigen::MatrixXd(upper.middleCols(1, n_));
  const Eigen::VectorXd truth = upper.col(n_ + 1) + origin_ * upper.col(0);
  const std::vector<Eigen::Index> used = originals(error, truth, learnt);
  const Eigen::MatrixXd own = error(Eigen::indexing::all, used);
  const Eigen::VectorXd lengths = column_lengths(upper, learnt)(used);
  if (form.non_negative || form.shrinkage != 0)
    solve_regularized(form, own, used, lengths, learnt);
  else
    solve(form, {own, upper.col(0), truth}, used, lengths, learnt);
  // One channel twice: the shortest weights are equal ones.
  for (const Eigen::Index i : used) {
    double times = 1;
    for (const auto& [copy, original] : learnt.copies) times += original == i ? 1 : 0;
    learnt.weights[i] /= times;
    for (const auto& [copy, original] : learnt.copies)
      if (original == i) learnt.weights[copy] = learnt.weights[i];
  }
  return learnt;
}

void LearntMean::take(const LearntWeights& learnt) {
  learnt_ = learnt;
  direct_ = learnt.weights.cwiseQuotient(learnt.gain);
  total_ = direct_.sum();
  constant_ = learnt.constant - direct_.dot(learnt.bias);
  // The sum of weights over gains is one but for rounding; the input's offset must not see that rounding.
  if ((learnt.gain.array() == 1).all() && std::abs(total_ - 1) < 1e-12) total_ = 1;
}

void LearntMean::exchange(LearntExchange& with, Eigen::Index channels) {
  LearntWeights learnt = learnt_;
  if (with.taking_in()) learnt.gain = learnt.bias = learnt.weights = Eigen::VectorXd(channels);
  with.numbers("gains", span_of(learnt.gain));
  with.numbers("biases", span_of(learnt.bias));
  with.numbers("weights", span_of(learnt.weights));
  with.number("constant", learnt.constant);
  with.number("variance", learnt.variance);
  if (!with.taking_in()) return;
  if ((learnt.gain.array() == 0).any()) throw input_error("E0866").says("learnt.gains: a gain of zero");
  take(learnt);
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

void remark_on(const LearntWeights& learnt, Findings& warnings) {
  for (const int i : learnt.without_signal)
    warnings.add("channel_without_signal", "left out a channel that does not follow the reference",
                 "channel " + std::to_string(i + 1));
  for (const auto& [copy, original] : learnt.copies)
    warnings.add("duplicate_channels", "found a channel that is a copy of another; they share a weight",
                 "channel " + std::to_string(copy + 1) + " of channel " + std::to_string(original + 1));
  if (learnt.dependent > 0)
    warnings.add("dependent_channels", "found channels that are combinations of others", {},
                 static_cast<std::uint64_t>(learnt.dependent));
}

}  // namespace libchar::fusion
