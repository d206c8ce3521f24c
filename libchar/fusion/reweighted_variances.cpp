#include "libchar/fusion/reweighted_variances.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numeric>

namespace libchar::fusion {
namespace {

/// Variances never reach the denormals, whatever is fed.
constexpr double kTiny = 1e-280;
/// Ratio of standard deviations of 1e13: beyond it the squares tell nothing.
constexpr double kSmallestRatio = 1e-26;
/// The falling gain of the start: a = 1 / (k + kStart).
constexpr double kStart = 10;
/// Instants that the start is made from.
constexpr int kFirstInstants = 16;

}  // namespace

ReweightedVariances::ReweightedVariances(std::size_t n, const ReweightingOptions& options)
    : options_(options),
      v_(n, options.start_variance > 0 ? options.start_variance : 1),
      inverse_(n, 1 / v_[0]),
      r_(n, 0),
      p_(n),
      b_(n),
      e_(n),
      everybody_(n),
      first_(options.start_variance > 0 ? 0 : n * kFirstInstants),
      started_(options.start_variance > 0) {
  std::iota(everybody_.begin(), everybody_.end(), 0);
}

double ReweightedVariances::fuse(const double* y, const int* index, int m) {
  index_ = index != nullptr ? index : everybody_.data();
  m_ = m;
  y_ = y;
  const double base = y[index_[0]];
  double sum = 0, weighted = 0;
  for (int k = 0; k < m; ++k) {
    const int i = index_[k];
    sum += inverse_[i];
    weighted += inverse_[i] * (y[i] - base);
  }
  fused_ = 1 / sum;
  const double shift = weighted * fused_;
  for (int k = 0; k < m; ++k) r_[index_[k]] = (y[index_[k]] - base) - shift;
  const double x = base + shift;
  x_ = x;
  const double ulp = std::numeric_limits<double>::epsilon() * x;
  rounding_ = std::max(ulp * ulp, kTiny);
  return x;
}

void ReweightedVariances::start(const double* y) {
  double squares = 0;
  for (int k = 0; k < m_; ++k) squares += r_[index_[k]] * r_[index_[k]];
  if (!(squares > 0)) return;  // channels that say the same tell nothing about their noise
  double* const row = &first_[static_cast<std::size_t>(first_instants_) * v_.size()];
  std::fill(row, row + v_.size(), std::numeric_limits<double>::quiet_NaN());
  for (int k = 0; k < m_; ++k) row[index_[k]] = y[index_[k]];
  if (++first_instants_ == kFirstInstants) start_from_pairs();
}

/// v_i = half the smallest mean square of y_i - y_j over the other channels: a noisy channel is far
/// from all others, a good one is near to the other good ones, whatever the ratios. The recursion
/// alone would need 1/gamma instants for each factor e.
void ReweightedVariances::start_from_pairs() {
  const std::size_t n = v_.size();
  const double nobody = std::numeric_limits<double>::infinity();
  std::fill(v_.begin(), v_.end(), nobody);
  for (std::size_t i = 1; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double sum = 0, count = 0;
      for (int k = 0; k < kFirstInstants; ++k) {
        const double d = first_[static_cast<std::size_t>(k) * n + i] -
                         first_[static_cast<std::size_t>(k) * n + j];
        if (!(std::abs(d) >= 0)) continue;
        sum += d * d;
        count += 1;
      }
      if (count == 0) continue;
      const double half = sum / (2 * count);
      v_[i] = std::min(v_[i], half);
      v_[j] = std::min(v_[j], half);
    }
  double largest = 0;
  for (const double v : v_) largest = v < nobody ? std::max(largest, v) : largest;
  const double lowest = std::max(largest * kSmallestRatio, rounding_);
  for (std::size_t i = 0; i < n; ++i) {
    v_[i] = v_[i] < nobody ? std::max(v_[i], lowest) : std::max(largest, lowest);
    inverse_[i] = 1 / v_[i];
  }
  instants_ = kFirstInstants;
  started_ = true;
}

double ReweightedVariances::gain() {
  const double lasting = 1 - options_.gamma;
  if (options_.start_variance > 0) return lasting;
  instants_ += 1;
  return std::max(lasting, 1 / (instants_ + kStart));
}

// The two below are compiled twice: for all channels, where the positions are the channels and
// loops over elements become vectors, and for some. Element for element both do the same, sums run
// in the same order: the bits agree.

template <bool kAll>
void ReweightedVariances::solve(double a, double lambda) {
  const int m = m_;
  const int* const index = index_;
  const auto at = [index](int k) { return kAll ? k : index[k]; };
  double* __restrict const p = p_.data();
  double* __restrict const b = b_.data();
  double* __restrict const e = e_.data();
  const double* const inverse = inverse_.data();
  const double* const r = r_.data();
  const double fused = fused_;
  for (int k = 0; k < m; ++k) {
    const int i = at(k);
    p[k] = inverse[i] * fused;
    b[k] = r[i] * r[i] * inverse[i] - (1 - p[k]);
  }
  // Without a ridge, two channels of weight one half each would divide by zero.
  const double smallest = std::max(1e-12, lambda);
  for (int k = 0; k < m; ++k) {
    const double information = 1 - 2 * p[k] + lambda;
    e[k] = 1 / (information > smallest ? information : smallest);
  }
  int heaviest = 0;
  for (int k = 1; k < m; ++k) heaviest = p[k] > p[heaviest] ? k : heaviest;
  heaviest_ = heaviest;
  double s1 = 0, s2 = 0;
  for (int k = 0; k < m; ++k) {
    const double pe = k == heaviest ? 0 : p[k] * e[k];
    s1 += pe * b[k];
    s2 += pe * p[k];
  }
  const double pm = p[heaviest], scale = (1 + s2) / pm;
  const double um = (b[heaviest] * scale - s1) / (pm + (1 - 2 * pm + lambda) * scale);
  const double t = (pm * um + s1) / (1 + s2);
  for (int k = 0; k < m; ++k) e[k] = 1 + a * (b[k] - p[k] * t) * e[k];
  e[heaviest] = 1 + a * um;
}

template <bool kAll>
void ReweightedVariances::apply() {
  const int m = m_;
  const int* const index = index_;
  const auto at = [index](int k) { return kAll ? k : index[k]; };
  double* __restrict const v = v_.data();
  double* __restrict const inverse = inverse_.data();
  const double* __restrict const e = e_.data();
  double largest = 0, others = 0;
  for (int k = 0; k < m; ++k) v[at(k)] *= e[k];
  for (int k = 0; k < m; ++k) {
    const int i = at(k);
    // Summed without the heaviest, not as a difference: beside it the others may be below rounding.
    others += k == heaviest_ ? 0 : inverse[i];
    largest = v[i] > largest ? v[i] : largest;
  }
  const double lowest = std::max({options_.floor / others,
                                  largest * std::max(options_.floor_largest, kSmallestRatio),
                                  rounding_});
  for (int k = 0; k < m; ++k) {
    const int i = at(k);
    const double kept = v[i] > lowest ? v[i] : lowest;
    v[i] = kept;
    inverse[i] = 1 / kept;
  }
}

void ReweightedVariances::update() {
  if (m_ < 3) return;  // two channels tell the sum of their variances only
  if (!started_) {
    start(y_);
    return;
  }
  const double a = gain();
  if (m_ == static_cast<int>(v_.size())) {  // index rises: nobody is left out
    solve<true>(a, options_.damping * a);
    apply<true>();
  } else {
    solve<false>(a, options_.damping * a);
    apply<false>();
  }
}

Eigen::MatrixXd ReweightedVariances::weights() const {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(v_.size()), 1);
  for (int k = 0; k < m_; ++k) weights(index_[k], 0) = inverse_[index_[k]];
  return m_ > 0 ? Eigen::MatrixXd(weights / weights.sum()) : weights;
}

double ReweightedVariances::blindness(std::vector<double>& direction) const {
  const auto n = static_cast<Eigen::Index>(v_.size());
  const Eigen::Map<const Eigen::VectorXd> inverse(inverse_.data(), n);
  const Eigen::VectorXd p = inverse / inverse.sum();
  Eigen::MatrixXd information = p * p.transpose();
  information.diagonal() += (1 - 2 * p.array()).matrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  direction.assign(eigen.eigenvectors().col(0).data(), eigen.eigenvectors().col(0).data() + n);
  return std::sqrt((1 - options_.gamma) / std::max(eigen.eigenvalues()[0], 1e-300));
}

}  // namespace libchar::fusion
