// v = mean of M squared Gaussian terms d_i with autocovariance R(l), terms `q` samples apart, mean mu (ramp):
//   E v = R(0) + mu^2,   Var v = (2/M^2) sum_k (M - |k|) [R(qk)^2 + 2 mu^2 R(qk)],
//   edf = 2 (E v)^2 / Var v
// exact for the discrete mixture; R from equivalent_dof.hpp. White, m = 1: 2M/3. Walk, m = 1: M.
//
// Total deviation: Howe & Greenhall 1997, Greenhall, Howe & Percival 1999: edf = b T/tau - c with
// (b, c) = (1.500, 0) white, (1.168, 0.222) flicker, (0.927, 0.358) walk. That is an expansion for
// m >> 1; at small m it promises more than there is. Used here: the exact edf of the overlapping
// deviation plus what the reflection adds to it for m >> 1, but not above it.

#include "libchar/allan/detail/equivalent_dof.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "libchar/allan/detail/kernels/lag_sum.hpp"
#include "libchar/allan/noise_curves.hpp"

namespace libchar {

// With s(n) the generalised covariance of the phase (noise_curves.hpp), T(n) its double sum and delta2_m
// f(n) = f(n+m) - 2 f(n) + f(n-m): products of differences have covariance equal to the differences of s. White, walk
// and quantization are piecewise polynomials, so that everything vanishes beyond the reach of the differences; flicker
// leaves a tail delta4 s ~ -m^4/(pi n^2). Far from its kinks flicker is developed in the derivatives of
//   4 pi s(n) = 2 n^2 ln n + (2 gamma + 4 ln 2 - 3) n^2 - (ln n)/2 + const - 17/(480 n^2) + …

namespace {

constexpr double kFar = 24;  // steps; the neglected terms of the developments are below 1e-9 of the value there
constexpr double kFourPi = 4 * std::numbers::pi;

constexpr std::size_t kWhite = 0, kFlicker = 1, kWalk = 2, kQuantization = 3;

/// delta2_m s of unit driving variance, from |n| = n >= 0.
double white_difference(double n, double m) { return n < m ? -(m - n) : 0.0; }

double walk_difference(double n, double m) {
  if (n >= m) return m * m * n / 2;
  return (m * (m * m - 1) + 3 * m * n * n - n * (n * n - 1)) / 6;
}

double quantization_difference(double n, double m) { return n == 0 ? -2.0 : n == m ? 1.0 : 0.0; }

double flicker(double n) { return phase_covariance(Term::flicker, n, 1); }

double flicker_difference(double n, double m) {
  if (n < kFar * m) return flicker(n + m) - 2 * flicker(n) + flicker(n - m);
  constexpr double kSlope = 2 * (2 * std::numbers::egamma + 4 * std::numbers::ln2 - 3) + 6;
  constexpr double kLast = 31.0 / 4032 + 7.0 / 1920;  // coefficient of n^-4 in 4 pi s
  const double w = 1 / (n * n), v = m * m * w;
  const double second = 4 * std::log(n) + kSlope + w * (0.5 - w * (17.0 / 80 - w * 20 * kLast));
  const double fourth = 4 - w * (3 - w * (17.0 / 4 - w * 840 * kLast));
  const double sixth = 24 - w * (60 - w * 178.5);
  const double eighth = 480 - w * 2520;
  return m * m *
         (second -
          v * (fourth / 12 + v * (sixth / 360 + v * (eighth / 20160 + v * (20160.0 / 1814400 + v * 0.00606))))) /
         kFourPi;
}

/// delta2_m1 delta2_m2 s / (m1^2 m2^2) far away.
double flicker_tail(double n, double m1, double m2) {
  const double w = 1 / (n * n), a = m1 * m1, b = m2 * m2;
  const double fourth = 4 - w * (3 - w * 17 / 4);
  const double sixth = (a + b) / 12 * (24 - 60 * w);
  const double eighth = ((a * a + b * b) / 360 + a * b / 144) * 480;
  const double tenth = ((a * a * a + b * b * b) / 20160 + a * b * (a + b) / 4320) * 20160;
  return -w * (fourth + w * (sixth + w * (eighth + w * tenth))) / kFourPi;
}

template <typename Difference>
double difference_again(Difference d, double n, double m) {
  return d(std::fabs(n + m)) - 2 * d(std::fabs(n)) + d(std::fabs(n - m));
}

constexpr double kSixth[4] = {-20, 15, -6, 1};  // weights of delta6 at 0, ±1, ±2, ±3

template <typename Function>
double sixth_difference(Function f, double n, double m) {
  double sum = kSixth[0] * f(n);
  for (int j = 1; j <= 3; ++j) sum += kSixth[j] * (f(n + j * m) + f(n - j * m));
  return sum;
}

/// Same skeleton for Hadamard and modified terms: `f` is s or T, `tail` the development of flicker.
template <typename Function, typename Tail>
PerTerm sixth_differences(Function f, Tail tail, double m, double lag, double factor, double dt) {
  PerTerm value{};
  const double n = std::fabs(lag);
  for (const Term t : {Term::white, Term::walk, Term::quantization})
    if (n < 3 * m || (t == Term::quantization && n == 3 * m))
      value[static_cast<std::size_t>(t)] = factor * sixth_difference([&](double p) { return f(t, p, dt); }, n, m);
  value[kFlicker] =
      n < kFar * m ? factor * sixth_difference([&](double p) { return f(Term::flicker, p, 1.0); }, n, m) : tail(n);
  return value;
}

/// Same for the third difference (Hadamard): -delta6_m s(lag) / m^2.
PerTerm hadamard_term_covariance(double m, double lag, double dt_s) {
  // -delta6 s = -m^6 (s^(6) + m^2 s^(8)/4 + 13 m^4 s^(10)/240), 4 pi s^(6) = -24/n^4 …
  const auto tail = [m](double n) {
    const double v = m * m / (n * n);
    return v * v * (24 + v * (120 + v * 1092)) / kFourPi;
  };
  return sixth_differences(phase_covariance, tail, m, lag, -1 / (m * m), dt_s);
}

/// Same for the second difference of the phase averaged over m points (modified Allan): delta6_m T(lag) / m^4.
PerTerm modified_term_covariance(double m, double lag, double dt_s) {
  // delta6 T/m^4 = m^2 (s'''' + m^2 s^(6)/4 + 13 m^4 s^(8)/240), since T'' = s up to terms of order m^-2
  const auto tail = [m](double n) {
    const double v = m * m / (n * n);
    return -v * (4 + v * (6 + v * 26)) / kFourPi;
  };
  return sixth_differences(summed_phase_covariance, tail, m, lag, 1 / (m * m * m * m), dt_s);
}

}  // namespace

PerTerm allan_term_covariance(double m1, double m2, double lag, double dt_s, bool with_flicker) {
  const double small = std::min(m1, m2), large = std::max(m1, m2), n = std::fabs(lag);
  const double scale = 1 / (m1 * m2);
  PerTerm value{};
  if (n <= m1 + m2) {
    value[kWhite] = difference_again([&](double p) { return white_difference(p, small); }, n, large) * scale / dt_s;
    value[kWalk] = difference_again([&](double p) { return walk_difference(p, small); }, n, large) * scale * dt_s;
    value[kQuantization] =
        difference_again([&](double p) { return quantization_difference(p, small); }, n, large) * scale / (dt_s * dt_s);
  }
  if (!with_flicker) return value;
  value[kFlicker] = n > kFar * large
                        ? flicker_tail(n, m1, m2) / scale
                        : difference_again([&](double p) { return flicker_difference(p, small); }, n, large) * scale;
  return value;
}

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

double discrete_dof(Family family, const Mixture& theta, double m, double terms, double stride, double dt) {
  const bool flicker = theta[static_cast<std::size_t>(Term::flicker)] > 0;
  const auto at = [&](double lag) {
    const PerTerm unit = covariance(family, m, lag, dt, flicker);
    double sum = 0;
    for (std::size_t t = 0; t < kRandomTerms; ++t) sum += theta[t] * unit[t];
    return sum;
  };
  // Ramp: y = R t has second difference R tau m, here divided by m; third difference 0.
  const double tau = m * dt, mean_square = family.third ? 0 : theta[static_cast<std::size_t>(Term::ramp)] * tau * tau;
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
  const double overlapping = overlapping_terms >= 1 ? discrete_dof({}, theta, m, overlapping_terms, 1, dt) : 0;
  const PerTerm share = allan_shares(theta, m, dt);
  double gain = 0, limit = 0;
  for (std::size_t t = 0; t < kRandomTerms; ++t) {
    gain += share[t] * kGain[t];
    limit += share[t] * (kSlope[t] * pieces - kOffset[t]);
  }
  return std::max(1.0, overlapping < 1 ? limit : std::min(overlapping + gain, std::max(limit, overlapping)));
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

double equivalent_dof(DeviationType type, const Mixture& theta, std::uint64_t m, std::uint64_t terms,
                      std::uint64_t stride, double dt_s) {
  assert(m >= 1 && terms >= 1 && stride >= 1 && dt_s > 0);
  const double factor = static_cast<double>(m), count = static_cast<double>(terms);
  if (deviation_row(type).reflected) return total_dof(theta, factor, count, dt_s);
  return discrete_dof(family_of(type), theta, factor, count, static_cast<double>(stride), dt_s);
}

}  // namespace libchar
