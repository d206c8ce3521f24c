#include "libchar/core/numeric/distributions.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace libchar {

using boost::math::binomial;
using boost::math::cdf;
using boost::math::complement;
using boost::math::fisher_f;
using boost::math::quantile;
using boost::math::students_t;

double student_quantile(double probability, double dof) { return quantile(students_t(dof), probability); }

double student_tail(double t, double dof) { return cdf(complement(students_t(dof), t)); }

double fisher_cdf(double f, double dof1, double dof2) { return cdf(fisher_f(dof1, dof2), f); }

double fisher_tail(double f, double dof1, double dof2) { return cdf(complement(fisher_f(dof1, dof2), f)); }

double fisher_upper_quantile(double tail, double dof1, double dof2) {
  return quantile(complement(fisher_f(dof1, dof2), tail));
}

double binomial_cdf(double k, double trials, double each) { return cdf(binomial(trials, each), k); }

double binomial_tail(double k, double trials, double each) { return cdf(complement(binomial(trials, each), k)); }

}  // namespace libchar
