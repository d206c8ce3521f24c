// v = mean of M squared Gaussian terms d_i with autocovariance R(l), terms `q` samples apart, mean
// mu (ramp):
//   E v = R(0) + mu^2,   Var v = (2/M^2) sum_k (M - |k|) [R(qk)^2 + 2 mu^2 R(qk)],
//   edf = 2 (E v)^2 / Var v
// exact for the discrete mixture; R from term_covariance.hpp. White, m = 1: 2M/3. Walk, m = 1: M.
//
// Total deviation: Howe & Greenhall 1997, Greenhall, Howe & Percival 1999: edf = b T/tau - c with
// (b, c) = (1.500, 0) white, (1.168, 0.222) flicker, (0.927, 0.358) walk. That is an expansion for
// m >> 1; at small m it promises more than there is. Used here: the exact edf of the overlapping
// deviation plus what the reflection adds to it for m >> 1, but not above it.

#include "libchar/allan/detail/equivalent_dof.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "libchar/allan/detail/kernels/lag_sum.hpp"
#include "libchar/allan/detail/term_covariance.hpp"
#include "libchar/allan/noise_curves.hpp"

namespace libchar {
namespace {

constexpr double kCertain = 1e15;  // a ramp alone has no spread

struct Family {
  bool third, modified;
  double reach() const { return third || modified ? 3 : 2; }
};

Family family_of(DeviationType type) {
  const DeviationRow& row = deviation_row(type);
  return {row.order == 3 && !row.of_sum, row.of_sum};
}

PerTerm covariance(Family family, double m, double lag, double dt, bool with_flicker) {
  if (family.third) return hadamard_term_covariance(m, lag, dt);
  if (family.modified) return modified_term_covariance(m, lag, dt);
  return allan_term_covariance(m, m, lag, dt, with_flicker);
}

/// sum_k (M - |k|) R^2 and sum_k (M - |k|) R.
struct Sums {
  double square = 0, single = 0;
  void operator+=(const Sums& o) {
    square += o.square;
    single += o.single;
  }
  Sums operator*(double w) const { return {square * w, single * w}; }
};

double discrete_dof(
    Family family, const Mixture& theta, double m, double terms, double stride, double dt) {
  const bool flicker = theta[static_cast<std::size_t>(Term::flicker)] > 0;
  const auto at = [&](double lag) {
    const PerTerm unit = covariance(family, m, lag, dt, flicker);
    double sum = 0;
    for (std::size_t t = 0; t < kRandomTerms; ++t) sum += theta[t] * unit[t];
    return sum;
  };
  // Ramp: y = R t has second difference R tau m, here divided by m; third difference 0.
  const double tau = m * dt,
               mean_square =
                   family.third ? 0 : theta[static_cast<std::size_t>(Term::ramp)] * tau * tau;
  const double variance = at(0);
  if (!(variance > 0)) return mean_square > 0 ? kCertain : terms;
  const auto weighted = [&](double k) {
    const double r = at(k * stride) / variance;
    return Sums{(terms - k) * r * r, (terms - k) * r};
  };
  std::vector<double> breakpoints;
  for (double j = 1; j <= family.reach(); ++j) breakpoints.push_back(j * m / stride);
  const Sums side = lag_sum<Sums>(weighted, 1, terms - 1, breakpoints);
  const double mu = mean_square / variance;
  const double total = (terms + 2 * side.square) + 2 * mu * (terms + 2 * side.single);
  return std::clamp(terms * terms * (1 + mu) * (1 + mu) / total, 1.0, kCertain);
}

double total_dof(const Mixture& theta, double m, double terms, double dt) {
  constexpr PerTerm kSlope = {1.500, 1.168, 0.927, 1.500}, kOffset = {0, 0.222, 0.358, 0};
  constexpr PerTerm kGain = {2.185, 1.542, 1.162, 0};  // over the overlapping deviation, m >> 1
  const double samples = terms + 1, pieces = samples / m;
  const double overlapping_terms = samples - 2 * m + 1;
  const double overlapping =
      overlapping_terms >= 1 ? discrete_dof({}, theta, m, overlapping_terms, 1, dt) : 0;
  const PerTerm share = allan_shares(theta, m, dt);
  double gain = 0, limit = 0;
  for (std::size_t t = 0; t < kRandomTerms; ++t) {
    gain += share[t] * kGain[t];
    limit += share[t] * (kSlope[t] * pieces - kOffset[t]);
  }
  return std::max(
      1.0, overlapping < 1 ? limit : std::min(overlapping + gain, std::max(limit, overlapping)));
}

}  // namespace

PerTerm allan_shares(const Mixture& theta, double m, double dt) {
  PerTerm share{};
  double sum = 0;
  for (std::size_t t = 0; t < kRandomTerms; ++t)
    sum += share[t] = theta[t] * unit_allan_variance(static_cast<Term>(t), m, dt);
  if (sum > 0)
    for (double& s : share) s /= sum;
  return share;
}

double equivalent_dof(DeviationType type,
                      const Mixture& theta,
                      std::uint64_t m,
                      std::uint64_t terms,
                      std::uint64_t stride,
                      double dt_s) {
  assert(m >= 1 && terms >= 1 && stride >= 1 && dt_s > 0);
  const double factor = static_cast<double>(m), count = static_cast<double>(terms);
  if (deviation_row(type).reflected) return total_dof(theta, factor, count, dt_s);
  return discrete_dof(family_of(type), theta, factor, count, static_cast<double>(stride), dt_s);
}

}  // namespace libchar
