#include "libchar/fusion/detail/variances/pair_moments.hpp"

#include <algorithm>

namespace libchar::fusion {

PairMoments::PairMoments(Eigen::Index n, double gamma, bool about_zero)
    : gamma_(gamma),
      about_zero_(about_zero),
      mean_(Eigen::MatrixXd::Zero(n, n)),
      square_(Eigen::MatrixXd::Zero(n, n)),
      missing_(Eigen::MatrixXd::Ones(n, n)),
      moments_(Eigen::VectorXd::Zero(n)) {}

/// As below where all channels are there, with the same bits: the loops run over neighbours in memory.
void PairMoments::update_all(const double* y) {
  const double gain = 1 - gamma_, gamma = gamma_;
  for (Eigen::Index i = 1; i < square_.cols(); ++i) {
    double* const square = square_.col(i).data();
    double* const mean = mean_.col(i).data();
    double* const missing = missing_.col(i).data();
    const double own = y[i];
    if (about_zero_)
      for (Eigen::Index j = 0; j < i; ++j) {
        const double d = own - y[j];
        square[j] = gamma * square[j] + gain * d * d;
      }
    else
      for (Eigen::Index j = 0; j < i; ++j) {
        const double d = own - y[j], delta = d - mean[j];
        const bool first = missing[j] == 1;
        square[j] = first ? square[j] : gamma * (square[j] + gain * delta * delta);
        mean[j] = first ? d : mean[j] + gain * delta;
      }
    for (Eigen::Index j = 0; j < i; ++j) missing[j] *= gamma;
  }
}

void PairMoments::update(const double* y, const int* index, int m) {
  if (m == square_.cols()) return update_all(y);
  const double gain = 1 - gamma_;
  // index rises, so j < i: the upper triangle, in which neighbours of a row's pairs stand side by side.
  for (int a = 1; a < m; ++a) {
    const int i = index[a];
    for (int b = 0; b < a; ++b) {
      const int j = index[b];
      const double d = y[i] - y[j];
      if (about_zero_) {
        square_(j, i) = gamma_ * square_(j, i) + gain * d * d;
      } else if (missing_(j, i) == 1) {
        mean_(j, i) = d;
      } else {
        const double delta = d - mean_(j, i);
        square_(j, i) = gamma_ * (square_(j, i) + gain * delta * delta);
        mean_(j, i) += gain * delta;
      }
      missing_(j, i) *= gamma_;
    }
  }
}

double PairMoments::moment(Eigen::Index i, Eigen::Index j) const {
  const Eigen::Index low = std::min(i, j), high = std::max(i, j);
  const double square = square_(low, high);
  return about_zero_ && missing_(low, high) < 1 ? square / (1 - missing_(low, high)) : square;
}

/// As below where all channels are there; sums of a channel's moments in another order.
void PairMoments::variances_of_all(double* v) const {
  const Eigen::Index n = square_.cols();
  double total = 0;
  std::fill(v, v + n, 0.0);
  for (Eigen::Index i = 1; i < n; ++i) {
    const double* const square = square_.col(i).data();
    const double* const missing = missing_.col(i).data();
    double* const d = moments_.data();
    for (Eigen::Index j = 0; j < i; ++j)
      d[j] = about_zero_ && missing[j] < 1 ? square[j] / (1 - missing[j]) : square[j];
    for (Eigen::Index j = 0; j < i; ++j) v[j] += d[j];
    const double own = moments_.head(i).sum();
    v[i] += own;
    total += own;
  }
  const auto m = static_cast<double>(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = (v[i] - total / (m - 1)) / (m - 2);
}

void PairMoments::variances(const int* index, int m, double* v) const {
  if (m == square_.cols()) return variances_of_all(v);
  double total = 0;
  for (int a = 0; a < m; ++a) v[index[a]] = 0;
  for (int a = 1; a < m; ++a)
    for (int b = 0; b < a; ++b) {
      const double d = moment(index[a], index[b]);
      v[index[a]] += d;
      v[index[b]] += d;
      total += d;
    }
  for (int a = 0; a < m; ++a) v[index[a]] = (v[index[a]] - total / (m - 1)) / (m - 2);
}

double PairMoments::variance_beside(int channel, const int* index, int m) const {
  // The formula of m + 1 channels, written for one of them.
  double own = 0, total = 0;
  for (int a = 0; a < m; ++a) {
    own += moment(channel, index[a]);
    for (int b = 0; b < a; ++b) total += moment(index[a], index[b]);
  }
  return (own - (own + total) / m) / (m - 1);
}

}  // namespace libchar::fusion
