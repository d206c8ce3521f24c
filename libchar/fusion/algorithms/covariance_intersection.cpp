#include "libchar/fusion/algorithms/covariance_intersection.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libchar/core/numeric/dense.hpp"

namespace libchar::fusion {
namespace {

constexpr int kRounds = 3000;
constexpr double kDone = 1e-10;
/// A share below it tells nothing; and its variance v / w must stay a number.
constexpr double kSmallestShare = 1e-9;

/// Shares of the least det P.
Eigen::VectorXd least_bound(const Eigen::MatrixXd& h, const Eigen::VectorXd& levels) {
  const auto n = static_cast<double>(h.rows()), r = static_cast<double>(h.cols());
  const Eigen::MatrixXd scaled = levels.cwiseSqrt().cwiseInverse().asDiagonal() * h;
  Eigen::VectorXd w = Eigen::VectorXd::Constant(h.rows(), 1 / n);
  for (int round = 0; round < kRounds; ++round) {
    // h_i' P h_i w_i / v_i is the leverage of row i of sqrt(w) R^-1/2 H.
    const Eigen::MatrixXd q = thin_qr(w.cwiseSqrt().asDiagonal() * scaled).q;
    const Eigen::VectorXd next = q.rowwise().squaredNorm() / r;
    const double change = (next - w).cwiseAbs().maxCoeff();
    w = next;
    if (change < kDone) break;
  }
  return w;
}

}  // namespace

CovarianceIntersection::CovarianceIntersection(const Array& array, const Settings& settings)
    : levels_(array.noise_levels) {
  const Eigen::Index n = array.channels;
  const double least = levels_.minCoeff();
  order_.resize(static_cast<std::size_t>(n));
  std::iota(order_.begin(), order_.end(), Eigen::Index{0});
  std::stable_sort(order_.begin(), order_.end(),
                   [this](Eigen::Index a, Eigen::Index b) { return levels_[a] < levels_[b]; });
  if (settings["fast"] != 0) {
    shares_ = (least / levels_.array()).matrix();
    order_.clear();
  } else if (array.one_common_input()) {
    shares_ = (levels_.array() == least).cast<double>();
  } else {
    shares_ = least_bound(array.h(), levels_);
    order_.clear();
  }
  shares_ = shares_.cwiseMax(kSmallestShare);
  shares_ /= shares_.sum();
  mean_ = std::make_unique<GeneralMean>(array.h(), levels_.cwiseQuotient(shares_));
}

Estimate CovarianceIntersection::best_present(const Sample& y) const {
  // Of equals the mean, whose bound is that of each: then their order says nothing.
  double sum = 0, alike = 0, base = 0, level = std::nan("");
  for (const Eigen::Index i : order_) {
    if (!usable(y[i])) continue;
    if (alike == 0) {
      base = y[i];
      level = levels_[i];
    }
    if (levels_[i] > level) break;
    sum += y[i] - base;
    alike += 1;
  }
  return alike == 0 ? Estimate::none(1) : Estimate::scalar(base + sum / alike, level);
}

Estimate CovarianceIntersection::step(const Sample& y) {
  Estimate estimate = mean_->step(y);
  if (!order_.empty()) return best_present(y);
  double present = 0;
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (usable(y[i])) present += shares_[i];
  estimate.variance *= present;
  return estimate;
}

}  // namespace libchar::fusion
