#include "libchar/fusion/detail/variances/generalized_least_squares.hpp"

#include <cmath>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

namespace {

/// A column of which so little is left beside the others is no further input.
constexpr double kDependent = 1e-11;

}  // namespace

GeneralizedLeastSquares::GeneralizedLeastSquares(const Eigen::MatrixXd& h)
    : h_(h), q_(h.rows(), h.cols()), upper_(h.cols(), h.cols()), inverse_(h.cols(), h.cols()), root_(h.rows()) {
  q_.setZero();
  upper_.setZero();
  inverse_.setZero();
}

bool GeneralizedLeastSquares::factor(const double* variances, const int* index, int m) {
  index_ = index;
  m_ = m;
  const Eigen::Index r = h_.cols();
  if (m < r) return false;
  for (int k = 0; k < m; ++k) {
    root_[k] = 1 / std::sqrt(variances[index[k]]);
    for (Eigen::Index j = 0; j < r; ++j) q_(k, j) = root_[k] * h_(index[k], j);
  }
  upper_.setZero();
  // Gram-Schmidt, twice is enough (Giraud, Langou & Rozložník 2005).
  for (Eigen::Index j = 0; j < r; ++j) {
    const double length = q_.col(j).head(m).norm();
    for (int pass = 0; pass < 2; ++pass)
      for (Eigen::Index i = 0; i < j; ++i) {
        const double projection = q_.col(i).head(m).dot(q_.col(j).head(m));
        upper_(i, j) += projection;
        q_.col(j).head(m) -= projection * q_.col(i).head(m);
      }
    const double left = q_.col(j).head(m).norm();
    if (!(left > kDependent * length)) return false;
    upper_(j, j) = left;
    q_.col(j).head(m) /= left;
  }
  for (Eigen::Index j = 0; j < r; ++j) {
    inverse_(j, j) = 1 / upper_(j, j);
    for (Eigen::Index i = j - 1; i >= 0; --i) {
      double sum = 0;
      for (Eigen::Index k = i + 1; k <= j; ++k) sum += upper_(i, k) * inverse_(k, j);
      inverse_(i, j) = -sum / upper_(i, i);
    }
  }
  return true;
}

void GeneralizedLeastSquares::solve(const double* y, double* x, double* residual) const {
  const Eigen::Index r = h_.cols();
  double projection[kMaxStates];
  for (Eigen::Index j = 0; j < r; ++j) {
    double sum = 0;
    for (int k = 0; k < m_; ++k) sum += q_(k, j) * (root_[k] * y[index_[k]]);
    projection[j] = sum;
  }
  for (Eigen::Index j = r - 1; j >= 0; --j) {
    double sum = projection[j];
    for (Eigen::Index k = j + 1; k < r; ++k) sum -= upper_(j, k) * x[k];
    x[j] = sum / upper_(j, j);
  }
  for (int k = 0; k < m_; ++k) {
    double fitted = 0;
    for (Eigen::Index j = 0; j < r; ++j) fitted += h_(index_[k], j) * x[j];
    residual[index_[k]] = y[index_[k]] - fitted;
  }
}

double GeneralizedLeastSquares::leverage(int k) const { return q_.row(k).squaredNorm(); }

double GeneralizedLeastSquares::predicted_variance(Eigen::Index i) const {
  double sum = 0;
  for (Eigen::Index j = 0; j < h_.cols(); ++j) {
    const double projection = h_.row(i).head(j + 1).dot(inverse_.col(j).head(j + 1));
    sum += projection * projection;
  }
  return sum;
}

Eigen::MatrixXd GeneralizedLeastSquares::gain() const {
  Eigen::MatrixXd gain = upper_times_transposed(inverse_, q_, m_);
  for (int k = 0; k < m_; ++k) gain.col(k) *= root_[k];
  return gain;
}

GeneralMean::GeneralMean(const Eigen::MatrixXd& h, const Eigen::VectorXd& variances)
    : gls_(h), variances_(variances), residual_(h.rows()) {
  present_.reserve(static_cast<std::size_t>(h.rows()));
  before_.reserve(present_.capacity());
  for (int i = 0; i < h.rows(); ++i) present_.push_back(i);
  determined_ = gls_.factor(variances_.data(), present_.data(), static_cast<int>(present_.size()));
}

// The factors refer to the list `present_`, so that it is only written when it changes.
bool GeneralMean::take_present(const Sample& y) {
  before_.clear();
  for (int i = 0; i < y.size(); ++i)
    if (usable(y[i])) before_.push_back(i);
  if (before_ == present_) return determined_;
  present_.assign(before_.begin(), before_.end());
  determined_ = !present_.empty() && gls_.factor(variances_.data(), present_.data(), static_cast<int>(present_.size()));
  return determined_;
}

Estimate GeneralMean::step(const Sample& y) {
  Estimate estimate = Estimate::none(gls_.inputs());
  if (!take_present(y)) return estimate;
  gls_.solve(y.data(), estimate.x.data(), residual_.data());
  for (Eigen::Index j = 0; j < gls_.inputs(); ++j) estimate.variance[j] = gls_.variance(j);
  return estimate;
}

Eigen::MatrixXd GeneralMean::weights() const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(gls_.h().rows(), gls_.inputs());
  if (!determined_) return out;
  const Eigen::MatrixXd gain = gls_.gain();
  for (std::size_t k = 0; k < present_.size(); ++k)
    out.row(present_[k]) = gain.col(static_cast<Eigen::Index>(k)).transpose();
  return out;
}

}  // namespace libchar::fusion
