#include "libchar/fusion/detail/variances/reweighted_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/fusion/detail/variances/reweighting_limits.hpp"

namespace libchar::fusion {

ReweightedMatrix::ReweightedMatrix(const Eigen::MatrixXd& h, const ReweightingOptions& options)
    : options_(options),
      gls_(h),
      v_(static_cast<std::size_t>(h.rows()), options.start_variance > 0 ? options.start_variance : 1),
      residual_variance_(v_.size(), 0),
      r_(Eigen::VectorXd::Zero(h.rows())),
      right_(h.rows()),
      squares_(Eigen::VectorXd::Zero(h.rows())),
      information_(h.rows(), h.rows()),
      x_(State::Zero(h.cols())),
      index_(v_.size()),
      started_(options.start_variance > 0) {}

bool ReweightedMatrix::factor(const int* index, int m) {
  if (factored_ && m == m_ && std::equal(index, index + m, index_.begin())) return determined_;
  if (factored_ && determined_ && gathered_ > 0) improve();
  std::copy(index, index + m, index_.begin());
  m_ = m;
  gathered_ = 0;
  squares_.setZero();
  factored_ = true;
  determined_ = gls_.factor(v_.data(), index_.data(), m);
  if (determined_)
    for (int k = 0; k < m; ++k) {
      const auto i = static_cast<std::size_t>(index_[static_cast<std::size_t>(k)]);
      residual_variance_[i] = v_[i] * std::max(1 - gls_.leverage(k), 0.0);
    }
  return determined_;
}

double ReweightedMatrix::fuse(const double* y, const int* index, int m) {
  if (!factor(index, m)) return std::numeric_limits<double>::quiet_NaN();
  gls_.solve(y, x_.data(), r_.data());
  double largest = 0;
  for (int k = 0; k < m; ++k) largest = std::max(largest, std::abs(y[index[k]]));
  const double ulp = std::numeric_limits<double>::epsilon() * largest;
  rounding_ = std::max(ulp * ulp, kTiny);
  return x_.sum();
}

void ReweightedMatrix::start() {
  double squares = 0;
  for (int k = 0; k < m_; ++k)
    squares += r_[index_[static_cast<std::size_t>(k)]] * r_[index_[static_cast<std::size_t>(k)]];
  if (!(squares > 0) || m_ <= gls_.inputs()) return;
  std::fill(v_.begin(), v_.end(), std::max(squares / static_cast<double>(m_ - gls_.inputs()), kTiny));
  started_ = true;
  factored_ = false;
}

void ReweightedMatrix::update() {
  const Eigen::Index free = m_ - gls_.inputs();
  if (!determined_ || free * (free + 1) / 2 < m_) return;
  if (!started_) {
    start();
    return;
  }
  for (int k = 0; k < m_; ++k) {
    const double r = r_[index_[static_cast<std::size_t>(k)]];
    squares_[k] += r * r;
  }
  gathered_ += 1;
  if (gathered_ < static_cast<double>(m_)) return;
  improve();
  factored_ = false;
}

void ReweightedMatrix::improve() {
  double a = 1 - std::pow(options_.gamma, gathered_);
  if (!(options_.start_variance > 0)) {
    instants_ += gathered_;
    a = std::max(a, gathered_ / (instants_ + kStart));
  }
  for (int k = 0; k < m_; ++k)
    right_[k] = squares_[k] / (gathered_ * v_[static_cast<std::size_t>(index_[static_cast<std::size_t>(k)])]) -
                (1 - gls_.leverage(k));
  // The ridge of one instant, whatever is gathered: it bounds the spread of the result, not the step.
  solve_information(std::max(options_.damping * a / gathered_, 1e-12));
  apply(a);
}

/// right_ <- (M o M + lambda I)^-1 right_ by Cholesky in place.
void ReweightedMatrix::solve_information(double lambda) {
  const auto& q = gls_.q();
  for (int j = 0; j < m_; ++j)
    for (int i = j; i < m_; ++i) {
      double entry = i == j ? 1 : 0;
      for (Eigen::Index c = 0; c < q.cols(); ++c) entry -= q(i, c) * q(j, c);
      information_(i, j) = entry * entry + (i == j ? lambda : 0);
    }
  for (int j = 0; j < m_; ++j) {
    for (int k = 0; k < j; ++k)
      for (int i = j; i < m_; ++i) information_(i, j) -= information_(i, k) * information_(j, k);
    const double root = std::sqrt(std::max(information_(j, j), 1e-14));
    for (int i = j; i < m_; ++i) information_(i, j) /= root;
    information_(j, j) = root;
  }
  for (int i = 0; i < m_; ++i) {
    for (int k = 0; k < i; ++k) right_[i] -= information_(i, k) * right_[k];
    right_[i] /= information_(i, i);
  }
  for (int i = m_ - 1; i >= 0; --i) {
    for (int k = i + 1; k < m_; ++k) right_[i] -= information_(k, i) * right_[k];
    right_[i] /= information_(i, i);
  }
}

void ReweightedMatrix::apply(double a) {
  double largest = 0, sum = 0, heaviest = 0;
  for (int k = 0; k < m_; ++k) {
    double& v = v_[static_cast<std::size_t>(index_[static_cast<std::size_t>(k)])];
    const double inverse = 1 / v;
    sum += inverse;
    heaviest = std::max(heaviest, inverse);
    v *= 1 + a * right_[k];
    largest = std::max(largest, v);
  }
  const double others = std::max(sum - heaviest, heaviest * 1e-20);
  const double lowest =
      std::max({options_.floor / others, largest * std::max(options_.floor_largest, kSmallestRatio), rounding_});
  for (int k = 0; k < m_; ++k) {
    double& v = v_[static_cast<std::size_t>(index_[static_cast<std::size_t>(k)])];
    v = std::max(v, lowest);
  }
}

void ReweightedMatrix::restart(double instants) { instants_ = std::min(instants_, instants); }

void ReweightedMatrix::assume(std::size_t i, double variance) {
  v_[i] = variance;
  factored_ = false;
  gathered_ = 0;
  squares_.setZero();
}

Estimate ReweightedMatrix::estimate() const {
  Estimate estimate{x_, State::Constant(x_.size(), std::numeric_limits<double>::quiet_NaN())};
  if (started_)
    for (Eigen::Index j = 0; j < x_.size(); ++j) estimate.variance[j] = gls_.variance(j);
  return estimate;
}

double ReweightedMatrix::innovation(std::size_t i, double sample) const {
  return sample - gls_.h().row(static_cast<Eigen::Index>(i)).dot(x_);
}

double ReweightedMatrix::innovation_variance(std::size_t i) const {
  return v_[i] + gls_.predicted_variance(static_cast<Eigen::Index>(i));
}

Eigen::MatrixXd ReweightedMatrix::weights() const {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(gls_.h().rows(), gls_.h().cols());
  if (!factored_ || !determined_) return weights;
  const Eigen::MatrixXd gain = gls_.gain();
  for (int k = 0; k < m_; ++k) weights.row(index_[static_cast<std::size_t>(k)]) = gain.col(k).transpose();
  return weights;
}

}  // namespace libchar::fusion
