// Terms d_i of two points (m1, n1 terms every q1 samples) and (m2, n2, q2), Gaussian with cross-covariance R12(lag):
//   Cov(A1, A2) = 1/(2 n1 n2) sum_{i,k} [R12^2 + 2 mu1 mu2 R12],   A = mean of d^2/2,   mu = R tau
//   (ramp)
// The double sum is one over lags, weighted with the number of pairs at each. Being quadratic in
// theta it is kept as the symmetric matrix of products of unit covariances (docs/theory/allan.md).

#include "libchar/allan/allan_covariance.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/detail/kernels/lag_sum.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

struct Side {
  double m, terms, stride;
};

/// Pairs of terms at lag number k (in units of the finer stride), k q1 = (position of term 2) - (position of term 1),
/// q2 = ratio q1. Exact for ratio 1; else the staircase smoothed, exact in its sums over a period.
struct PairCount {
  double n1, n2, ratio;
  double operator()(double k) const {
    const double high = std::min(n2 - 0.5, (k + n1 - 0.5) / ratio);
    const double low = std::max(-0.5, (k - 0.5) / ratio);
    return std::max(0.0, high - low);
  }
  double exact(double k) const {
    const double high = std::min(n2 - 1, std::floor((k + n1 - 1) / ratio));
    const double low = std::max(0.0, std::ceil(k / ratio));
    return std::max(0.0, high - low + 1);
  }
};

constexpr double kDirectLags = 2048;  // fewer are added one by one, with the exact number of pairs

std::vector<double> breakpoints(const Side& a, const Side& b, const PairCount& count, double start) {
  std::vector<double> at;
  for (const double i : {-1.0, 0.0, 1.0})
    for (const double j : {-1.0, 0.0, 1.0}) at.push_back((i * a.m + j * b.m - start) / a.stride);
  at.push_back(0.5 - count.ratio / 2);
  at.push_back(count.ratio * (count.n2 - 0.5) - count.n1 + 0.5);
  return at;
}

using Products = AllanCovariance::Products;

Products products(const PerTerm& r, double weight) {
  Products p;
  std::size_t next = 0;
  for (std::size_t t = 0; t < kRandomTerms; ++t)
    for (std::size_t u = t; u < kRandomTerms; ++u) p[next++] = weight * r[t] * r[u];
  for (std::size_t t = 0; t < kRandomTerms; ++t) p[next++] = weight * r[t];
  return p;
}

/// Sum over all pairs of terms; b.stride is a multiple of a.stride, the first terms' centres are `start` samples apart.
Products aligned_pair_sum(const Side& a, const Side& b, double start, double dt) {
  const PairCount count = {a.terms, b.terms, b.stride / a.stride};
  double low = -(a.terms - 1), high = count.ratio * (b.terms - 1);
  const bool few = high - low < kDirectLags;
  if (!few) {
    low = std::ceil(low - (count.ratio - 1) / 2);
    high = std::floor(high + (count.ratio - 1) / 2);
  }
  const auto f = [&](double k) {
    const double weight = few ? count.exact(k) : count(k);
    return products(allan_term_covariance(a.m, b.m, k * a.stride + start, dt), weight);
  };
  if (!few) return lag_sum<Products>(f, low, high, breakpoints(a, b, count, start));
  Products sum;
  for (double k = low; k <= high; ++k) sum += f(k);
  return sum;
}

/// Strides that do not divide each other: every P-th term of b is in step with a, so b is taken as P interleaved sets.
Products pair_sum(const Side& a, const Side& b, double dt) {
  const auto fine = static_cast<std::uint64_t>(a.stride), coarse = static_cast<std::uint64_t>(b.stride);
  const std::uint64_t apart = fine / std::gcd(fine, coarse);
  const double sets = std::min(static_cast<double>(apart), b.terms);
  Products sum;
  for (double first = 0; first < sets; ++first) {
    const Side part = {b.m, std::ceil((b.terms - first) / sets), b.stride * sets};
    sum += aligned_pair_sum(a, part, first * b.stride + b.m - a.m, dt);
  }
  return sum;
}

Side side_of(const AllanCurve& curve, const AllanPoint& p) {
  return {static_cast<double>(p.m), static_cast<double>(p.terms), static_cast<double>(stride_of(curve, p))};
}

double factor_of(const Side& a, const Side& b) { return 1 / (2 * a.terms * b.terms); }

}  // namespace

std::uint64_t stride_of(const AllanCurve& curve, const AllanPoint& point) {
  if (!deviation_row(curve.type).overlapping) return point.m;
  if (curve.stride_divisor == 0) return 1;
  return std::max<std::uint64_t>(1, point.m / curve.stride_divisor);
}

AllanCovariance::AllanCovariance(const AllanCurve& curve) : dt_s_(curve.dt_s) {
  if (!deviation_row(curve.type).is_allan())
    throw usage_error("E0202")
        .says("the covariance is known for Allan variances only")
        .got(std::string(name_of(curve.type)))
        .hint("use adev or oadev");
  size_ = curve.points.size();
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < size_; ++i) {
    tau_.push_back(curve.points[i].tau_s);
    for (std::size_t j = 0; j <= i; ++j) pairs.emplace_back(i, j);
  }
  products_.resize(pairs.size());
  parallel::for_each(0, pairs.size(), [&](std::size_t k) {
    Side a = side_of(curve, curve.points[pairs[k].first]), b = side_of(curve, curve.points[pairs[k].second]);
    if (a.stride > b.stride) std::swap(a, b);
    const double inflation = curve.points[pairs[k].first].inflation * curve.points[pairs[k].second].inflation;
    products_[k] = pair_sum(a, b, dt_s_) * (factor_of(a, b) * inflation);
  });
}

Eigen::MatrixXd AllanCovariance::at(const Mixture& theta) const {
  Eigen::MatrixXd matrix(size_, size_);
  const double ramp = theta[static_cast<std::size_t>(Term::ramp)];
  std::size_t k = 0;
  for (std::size_t i = 0; i < size_; ++i)
    for (std::size_t j = 0; j <= i; ++j, ++k) {
      double sum = 0;
      std::size_t next = 0;
      for (std::size_t t = 0; t < kRandomTerms; ++t)
        for (std::size_t u = t; u < kRandomTerms; ++u)
          sum += (t == u ? 1 : 2) * theta[t] * theta[u] * products_[k][next++];
      for (std::size_t t = 0; t < kRandomTerms; ++t)
        sum += 2 * ramp * tau_[i] * tau_[j] * theta[t] * products_[k][next++];
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = sum;
      matrix(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) = sum;
    }
  return matrix;
}

Eigen::MatrixXd allan_covariance(const AllanCurve& curve, const Mixture& theta) {
  return AllanCovariance(curve).at(theta);
}

std::shared_ptr<const AllanCovariance> AllanCovarianceCache::of(const AllanCurve& curve) {
  std::vector<std::uint64_t> key = {static_cast<std::uint64_t>(curve.type), curve.stride_divisor};
  for (const AllanPoint& point : curve.points)
    key.insert(key.end(), {point.m, point.terms, std::bit_cast<std::uint64_t>(point.inflation)});
  const std::lock_guard lock(mutex_);
  for (const Entry& entry : entries_)
    if (entry.dt_s == curve.dt_s && entry.key == key) return entry.covariance;
  // Who waits for its parts with the lock in hand begins nothing that may want it too.
  std::shared_ptr<const AllanCovariance> made;
  parallel::isolated([&] { made = std::make_shared<const AllanCovariance>(curve); });
  entries_.push_back({std::move(key), curve.dt_s, std::move(made)});
  return entries_.back().covariance;
}

}  // namespace libchar
