#include "libchar/core/numeric/distributions.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cassert>
#include <cmath>
#include <numbers>

namespace libchar {

using boost::math::binomial;
using boost::math::cdf;
using boost::math::complement;
using boost::math::quantile;

namespace {

// No promotion to long double: 1e-13 is reached without, three times faster.
using Double = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using fisher_f = boost::math::fisher_f_distribution<double, Double>;
using students_t = boost::math::students_t_distribution<double, Double>;

}  // namespace

double student_quantile(double probability, double dof) { return quantile(students_t(dof), probability); }

double student_tail(double t, double dof) { return cdf(complement(students_t(dof), t)); }

double fisher_cdf(double f, double dof1, double dof2) { return cdf(fisher_f(dof1, dof2), f); }

double fisher_tail(double f, double dof1, double dof2) { return cdf(complement(fisher_f(dof1, dof2), f)); }

double fisher_upper_quantile(double tail, double dof1, double dof2) {
  return quantile(complement(fisher_f(dof1, dof2), tail));
}

double binomial_cdf(double k, double trials, double each) { return cdf(binomial(trials, each), k); }

double binomial_tail(double k, double trials, double each) { return cdf(complement(binomial(trials, each), k)); }

// chi2_p(nu) = 2 P^-1(nu/2, p), P the regularised lower incomplete gamma function (Boost.Math) up
// to nu = 1e6. Beyond that Boost 1.74 loses digits and then gives up (1e6 terms of a series), while
// two expansions are exact to a rounding there:
//   quantile  Cornish & Fisher:  nu + sqrt(2 nu) z + 2(z^2 - 1)/3 + (z^3 - 7z)/(9 sqrt(2 nu)) - …
//   tail      Temme:             erfc(eta sqrt(a/2))/2
//                                + exp(-a eta^2/2)/sqrt(2 pi a) (-1/3 + eta/12 - 2 eta^2/135 …),
//                                a = nu/2, eta^2/2 = mu - ln(1 + mu), mu = x/nu - 1
//   density   Stirling:          exp(-a eta^2/2 - 1/(12 a)) / (2 (1 + mu) sqrt(2 pi a))

namespace {

// Errors come back as values, not exceptions.
using Policy =
    boost::math::policies::policy<boost::math::policies::promote_double<false>,
                                  boost::math::policies::domain_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::overflow_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::evaluation_error<boost::math::policies::ignore_error>>;

constexpr double kAllIsOne = 1e18;  // relative spread sqrt(2/nu) far below the interval's own rounding

constexpr double kHuge = 1e6;  // from here on the expansions
constexpr double kFar = 0.06;  // |x / nu - 1|: 40 standard deviations and more

/// z: standard normal quantile of the same probability.
double huge_quantile(double z, double nu) {
  const double w = z * z, root = std::sqrt(2 * nu);
  return nu + (root * z + 2 * (w - 1) / 3 + z * (w - 7) / (9 * root) - (w * (6 * w + 14) - 32) / (405 * nu) +
               z * (w * (9 * w + 256) - 433) / (4860 * nu * root));
}

// mu - ln(1 + mu), |mu| <= 0.06, without cancellation.
double log_excess(double mu) {
  double excess = 0, power = mu * mu;
  for (int k = 2; k < 16; ++k, power *= -mu) excess += power / k;
  return excess;
}

/// P(X > x), or P(X <= x) for side = -1.
double huge_tail(double x, double nu, double side) {
  const double a = nu / 2, mu = x / nu - 1;
  if (std::fabs(mu) > kFar) return side * mu > 0 ? 0 : 1;
  const double excess = log_excess(mu);
  const double eta = std::copysign(std::sqrt(2 * excess), mu);
  const double c = -1.0 / 3 + eta * (1.0 / 12 - eta * (2.0 / 135 - eta / 864)) - 1 / (540 * a);
  return std::erfc(side * eta * std::sqrt(a / 2)) / 2 +
         side * std::exp(-a * excess) / std::sqrt(2 * std::numbers::pi * a) * c;
}

// Stirling's formula for gamma(a).
double huge_density(double x, double nu) {
  const double a = nu / 2, mu = x / nu - 1;
  if (std::fabs(mu) > kFar) return 0;
  return std::exp(-a * log_excess(mu) - 1 / (12 * a)) / (2 * std::sqrt(2 * std::numbers::pi * a)) / (1 + mu);
}

}  // namespace

double chi_square_quantile(double probability, double dof) {
  assert(dof > 0 && probability > 0 && probability < 1);
  if (dof > kHuge) return huge_quantile(-std::numbers::sqrt2 * boost::math::erfc_inv(2 * probability, Policy()), dof);
  return 2 * boost::math::gamma_p_inv(dof / 2, probability, Policy());
}

double chi_square_upper_quantile(double tail, double dof) {
  assert(dof > 0 && tail > 0 && tail < 1);
  if (dof > kHuge) return huge_quantile(std::numbers::sqrt2 * boost::math::erfc_inv(2 * tail, Policy()), dof);
  return 2 * boost::math::gamma_q_inv(dof / 2, tail, Policy());
}

double chi_square_cdf(double x, double dof) {
  if (dof > kHuge) return huge_tail(x, dof, -1);
  return x <= 0 ? 0 : boost::math::gamma_p(dof / 2, x / 2, Policy());
}

double chi_square_tail(double x, double dof) {
  if (!(dof > 0)) return 1;
  if (dof > kHuge) return huge_tail(x, dof, 1);
  return x <= 0 ? 1 : boost::math::gamma_q(dof / 2, x / 2, Policy());
}

double chi_square_density(double x, double dof) {
  if (!(x > 0)) return 0;
  if (dof > kHuge) return huge_density(x, dof);
  return boost::math::gamma_p_derivative(dof / 2, x / 2, Policy()) / 2;
}

// Both by their recurrences up to an argument of ten, and from there by their asymptotic series (M. Abramowitz and I.
// A. Stegun, 6.3.18 and
// 6.4.12).
LogMoments chi_square_log_moments(double dof) {
  double x = dof / 2, psi = -std::log(x), derivative = 0;
  for (; x < 10; ++x) {
    psi -= 1 / x;
    derivative += 1 / (x * x);
  }
  const double r = 1 / (x * x);
  psi += std::log(x) - 0.5 / x - r * (1.0 / 12 - r * (1.0 / 120 - r * (1.0 / 252 - r * (1.0 / 240 - r / 132))));
  derivative += 1 / x + 0.5 * r + r / x * (1.0 / 6 - r * (1.0 / 30 - r * (1.0 / 42 - r * (1.0 / 30 - r * 5 / 66))));
  return {psi, derivative};
}

Interval chi_square_interval(double deviation, double edf, double confidence) {
  assert(confidence > 0 && confidence < 1);
  if (!(edf >= 1)) edf = 1;
  if (edf > kAllIsOne) return {deviation, deviation};
  const double tail = (1 - confidence) / 2;
  return {deviation * std::sqrt(edf / chi_square_upper_quantile(tail, edf)),
          deviation * std::sqrt(edf / chi_square_quantile(tail, edf))};
}

}  // namespace libchar
