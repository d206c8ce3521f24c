#include "libchar/fusion/detail/variances/reweighted_variances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/fusion/detail/variances/reweighting_limits.hpp"

namespace libchar::fusion {
namespace {

/// Instants that the start is made from, and how often they are gone through.
constexpr int kFirstInstants = 16, kPasses = 10;
/// The gain of the start falls as kFall / k: what is wrong at first is forgotten as 1 / k^kFall.
constexpr double kFall = 2;

}  // namespace

ReweightedVariances::ReweightedVariances(std::size_t n, const ReweightingOptions& options)
    : options_(options),
      v_(n, options.start_variance > 0 ? options.start_variance : 1),
      inverse_(n, 1 / v_[0]),
      r_(n, 0),
      p_(n, 0),
      shown_(n, 1),
      gathered_(n, 0),
      b_(n),
      e_(n),
      index_(n, -1),
      sorted_(options.start_variance > 0 ? 0 : n),
      usable_(sorted_.size()),
      first_(options.start_variance > 0 ? 0 : n * kFirstInstants),
      last_gain_(1 - options.gamma),
      started_(options.start_variance > 0) {}

// Loops over the channels in use are compiled twice: for all channels, where the positions are the
// channels and loops over elements become vectors, and for some. Element for element both do the
// same, sums run in the same order: the bits agree.

template <bool kAll>
double ReweightedVariances::fuse_in_use(const double* y) {
  const int m = m_;
  const int* const index = index_.data();
  const auto at = [index](int k) { return kAll ? k : index[k]; };
  const double* const p = p_.data();
  double* __restrict const r = r_.data();
  const double base = y[at(0)];
  double lanes[4] = {0, 0, 0, 0};
  int k = 0;
  for (; k + 4 <= m; k += 4)
    for (int lane = 0; lane < 4; ++lane) lanes[lane] += p[at(k + lane)] * (y[at(k + lane)] - base);
  for (int lane = 0; k < m; ++k, ++lane) lanes[lane] += p[at(k)] * (y[at(k)] - base);
  const double shift = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
  for (k = 0; k < m; ++k) r[at(k)] = (y[at(k)] - base) - shift;
  return base + shift;
}

double ReweightedVariances::fuse(const double* y, const int* index, int m) {
  if (index == nullptr ? !all() : m != m_ || (!all() && !std::equal(index, index + m, index_.data()))) use(index, m);
  y_ = y;
  x_ = !started_ ? median(y) : all() ? fuse_in_use<true>(y) : fuse_in_use<false>(y);
  const double ulp = std::numeric_limits<double>::epsilon() * x_;
  rounding_ = std::max(ulp * ulp, kTiny);
  return x_;
}

/// Before anything is known of the channels: one that is far off moves nothing.
double ReweightedVariances::median(const double* y) {
  for (int k = 0; k < m_; ++k) sorted_[static_cast<std::size_t>(k)] = y[index_[k]];
  const double x = median_in_place({sorted_.data(), static_cast<std::size_t>(m_)});
  for (int k = 0; k < m_; ++k) r_[index_[k]] = y[index_[k]] - x;
  return x;
}

void ReweightedVariances::begin(const double* variances, double instants) {
  for (std::size_t i = 0; i < v_.size(); ++i) {
    v_[i] = variances[i];
    inverse_[i] = 1 / v_[i];
  }
  instants_ = instants;
  started_ = true;
  weigh();
}

void ReweightedVariances::restart(double instants) { instants_ = std::min(instants_, instants); }

void ReweightedVariances::assume(std::size_t i, double variance) {
  if (gathered_gain_ > 0) renew(last_gain_);
  v_[i] = variance;
  inverse_[i] = 1 / variance;
  weigh();
}

void ReweightedVariances::use(const int* index, int m) {
  if (gathered_gain_ > 0) renew(last_gain_);
  m_ = m;
  if (index != nullptr)
    std::copy(index, index + m, index_.data());
  else
    std::iota(index_.begin(), index_.end(), 0);
  std::fill(p_.begin(), p_.end(), 0);
  weigh();
}

void ReweightedVariances::weigh() {
  double sum = 0;
  for (int k = 0; k < m_; ++k) sum += inverse_[index_[k]];
  fused_.variance = 1 / sum;
  for (int k = 0; k < m_; ++k) p_[index_[k]] = inverse_[index_[k]] * fused_.variance;
  for (int k = 0; k < m_; ++k) shown_[index_[k]] = v_[index_[k]] - fused_.variance;
  int heaviest = index_[0];
  for (int k = 1; k < m_; ++k) heaviest = p_[index_[k]] > p_[heaviest] ? index_[k] : heaviest;
  double others = 0;
  for (int k = 0; k < m_; ++k) others += index_[k] == heaviest ? 0 : inverse_[index_[k]];
  const double open = m_ > 1 ? p_[heaviest] * p_[heaviest] * std::sqrt(1 - options_.gamma) / others : 0;
  fused_.stated = fused_.variance + open * open / (fused_.variance + open);
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
  const double unused = std::numeric_limits<double>::infinity();
  std::fill(v_.begin(), v_.end(), unused);
  for (std::size_t i = 1; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double sum = 0, count = 0;
      for (int k = 0; k < kFirstInstants; ++k) {
        const double d = first_[static_cast<std::size_t>(k) * n + i] - first_[static_cast<std::size_t>(k) * n + j];
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
  for (const double v : v_) largest = v < unused ? std::max(largest, v) : largest;
  const double lowest = std::max(largest * kSmallestRatio, rounding_);
  for (std::size_t i = 0; i < n; ++i) {
    v_[i] = v_[i] < unused ? std::max(v_[i], lowest) : std::max(largest, lowest);
    inverse_[i] = 1 / v_[i];
  }
  instants_ = kFirstInstants;
  started_ = true;
  weigh();
  refine_start();
}

/// Scoring steps on the first instants together: at a gain that falls as 1/k a start that is r times
/// too large would need r times as many instants as it was made from.
void ReweightedVariances::refine_start() {
  constexpr double kShare = 1.0 / kFirstInstants;
  const double* const now = y_;
  const std::size_t n = v_.size();
  for (int pass = 0; pass < kPasses; ++pass) {
    for (int k = 0; k < kFirstInstants; ++k) {
      const double* const row = &first_[static_cast<std::size_t>(k) * n];
      int m = 0;
      for (std::size_t i = 0; i < n; ++i)
        if (std::abs(row[i]) >= 0) usable_[static_cast<std::size_t>(m++)] = static_cast<int>(i);
      fuse(row, usable_.data(), m);
      gather(kShare);
    }
    renew(kShare);
  }
  y_ = now;  // the last of them: weights and residuals are its own
}

double ReweightedVariances::gain() {
  const double lasting = 1 - options_.gamma;
  if (options_.start_variance > 0 || instants_ * lasting > kFall) return lasting;
  instants_ += 1;
  return std::max(lasting, kFall / (instants_ + kStart));
}

void ReweightedVariances::gather(double a) {
  gathered_gain_ += a;
  last_gain_ = a;
  gathered_rounding_ = rounding_;
  double* __restrict const sum = gathered_.data();
  const double* const r = r_.data();
  if (all())
    for (int i = 0; i < m_; ++i) sum[i] += a * (r[i] * r[i]);
  else
    for (int k = 0; k < m_; ++k) sum[index_[k]] += a * (r[index_[k]] * r[index_[k]]);
}

void ReweightedVariances::renew(double a) {
  const double lambda = options_.damping * a;
  if (all())
    apply<true>(solve<true>(lambda));
  else
    apply<false>(solve<false>(lambda));
  std::fill(gathered_.begin(), gathered_.end(), 0);
  gathered_gain_ = 0;
  gathered_instants_ = 0;
  weigh();
}

template <bool kAll>
int ReweightedVariances::solve(double lambda) {
  const int m = m_;
  const int* const index = index_.data();
  const auto at = [index](int k) { return kAll ? k : index[k]; };
  double* __restrict const b = b_.data();
  double* __restrict const e = e_.data();
  const double* const p = p_.data();
  const double* const inverse = inverse_.data();
  const double* const sum = gathered_.data();
  const double g = gathered_gain_;
  // Without a ridge, two channels of weight one half each would divide by zero.
  const double smallest = std::max(1e-12, lambda);
  for (int k = 0; k < m; ++k) {
    const int i = at(k);
    b[i] = sum[i] * inverse[i] - g * (1 - p[i]);
    const double information = 1 - 2 * p[i] + lambda;
    e[i] = 1 / (information > smallest ? information : smallest);
  }
  int heaviest = at(0);
  for (int k = 1; k < m; ++k) heaviest = p[at(k)] > p[heaviest] ? at(k) : heaviest;
  double s1 = 0, s2 = 0;
  for (int k = 0; k < m; ++k) {
    const int i = at(k);
    const double pe = i == heaviest ? 0 : p[i] * e[i];
    s1 += pe * b[i];
    s2 += pe * p[i];
  }
  const double pm = p[heaviest], scale = (1 + s2) / pm;
  // Where one channel is far better than all others, its information is (1 - pm)^2, and so is the harm of its spread.
  const double ridge = lambda * std::clamp(4 * (1 - pm) * (1 - pm), kLeastRidge, 1.0);
  const double um = (b[heaviest] * scale - s1) / (pm + (1 - 2 * pm + ridge) * scale);
  const double t = (pm * um + s1) / (1 + s2);
  for (int k = 0; k < m; ++k) {
    const int i = at(k);
    e[i] = 1 + (b[i] - p[i] * t) * e[i];
  }
  e[heaviest] = 1 + um;
  return heaviest;
}

template <bool kAll>
void ReweightedVariances::apply(int heaviest) {
  const int m = m_;
  const int* const index = index_.data();
  const auto at = [index](int k) { return kAll ? k : index[k]; };
  double* __restrict const v = v_.data();
  double* __restrict const inverse = inverse_.data();
  const double* __restrict const e = e_.data();
  double largest = 0, others = 0;
  for (int k = 0; k < m; ++k) v[at(k)] *= e[at(k)];
  for (int k = 0; k < m; ++k) {
    const int i = at(k);
    // Summed without the heaviest, not as a difference: beside it the others may be below rounding.
    others += i == heaviest ? 0 : inverse[i];
    largest = v[i] > largest ? v[i] : largest;
  }
  const double lowest = std::max(
      {options_.floor / others, largest * std::max(options_.floor_largest, kSmallestRatio), gathered_rounding_});
  for (int k = 0; k < m; ++k) {
    const int i = at(k);
    const double kept = v[i] > lowest ? v[i] : lowest;
    v[i] = kept;
    inverse[i] = 1 / kept;
  }
}

Eigen::MatrixXd ReweightedVariances::weights() const {
  return Eigen::Map<const Eigen::VectorXd>(p_.data(), static_cast<Eigen::Index>(p_.size()));
}

double ReweightedVariances::blindness(std::vector<double>& direction) const {
  const auto n = static_cast<Eigen::Index>(v_.size());
  const Eigen::Map<const Eigen::VectorXd> inverse(inverse_.data(), n);
  const Eigen::VectorXd p = inverse / inverse.sum();
  Eigen::MatrixXd information = p * p.transpose();
  information.diagonal() += (1 - 2 * p.array()).matrix();
  const SymmetricEigen eigen = symmetric_eigen(information);
  direction.assign(eigen.vectors.col(0).data(), eigen.vectors.col(0).data() + n);
  return std::sqrt((1 - options_.gamma) / std::max(eigen.values[0], 1e-300));
}

}  // namespace libchar::fusion
