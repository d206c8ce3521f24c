// A likelihood fit weighs all frequencies by their information; where the model is wrong at high frequencies it may buy
// a better fit there with slow coefficients that the record does not show. Two checks that do not share that weakness:
//  - the model's Allan deviation against the 99.7 % chi-square interval of the measured one, point by point;
//  - the covariance-weighted fit of the Allan curve, when the first fit does not describe the record (p < 1e-3).
// Both must differ by more than a fifth as well: at thousands of degrees of freedom a per cent is beyond chance and of
// no interest.
#include "libchar/fit/detail/band/contradiction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"

namespace libchar {
namespace {

constexpr double kConfidence = 0.997;
constexpr double kRelevant = 1.2;  // ratio of deviations below which a difference is not worth a word
constexpr double kFewestDof = 2;

struct Contradiction {
  double tau_s = 0, model = 0;
  Interval measured;
  double ratio = 1;
  std::size_t term = 0;  // that contributes most there
};

std::size_t largest_term(const Mixture& theta, double m, double dt_s) {
  std::size_t largest = 0;
  double most = -1;
  for (std::size_t t = 0; t < kTerms; ++t) {
    const double part = theta[t] * unit_allan_variance(static_cast<Term>(t), m, dt_s);
    if (part > most) {
      most = part;
      largest = t;
    }
  }
  return largest;
}

// The point where the model stands highest above what was measured.
std::optional<Contradiction> worst_contradiction(const NoiseFit& fit, const AllanCurve& allan) {
  AllanCurve curve = allan;
  add_fit_intervals(curve, fit);
  std::optional<Contradiction> worst;
  for (const AllanPoint& point : curve.points) {
    if (point.edf < kFewestDof || !(point.deviation > 0)) continue;
    const auto m = static_cast<double>(point.m);
    const double model = std::sqrt(shaped_allan_variance(fit, m, allan.dt_s));
    const Interval interval = chi_square_interval(point.deviation, point.edf, kConfidence);
    if (!std::isfinite(model)) continue;  // a shape far beyond the band that gave it
    const double ratio = model / point.deviation;
    if (model <= interval.high || ratio < kRelevant || (worst && ratio <= worst->ratio)) continue;
    worst = Contradiction{point.tau_s, model, interval, ratio, largest_term(fit.theta, m, allan.dt_s)};
  }
  return worst;
}

bool mostly_process(const NoiseFit& fit, double m, double dt_s) {
  return process_allan_variance(fit, m, dt_s) > 0.5 * shaped_allan_variance(fit, m, dt_s);
}

// Of a term, or of none (kTerms): its interval then reaches to what contradicts it.
void doubt(NoiseFit& fit, std::size_t term, double reach, const std::string& sentence) {
  fit.findings.push_back(finding("contradicted", sentence));
  if (term == kTerms) return;
  Coefficient& c = fit.term[term];
  if (c.status == Status::detected) c.status = Status::undetermined;
  if (!c.value) return;
  c.ci95.low = std::min(c.ci95.low, reach);
  c.ci95.high = std::max(c.ci95.high, reach);
}

}  // namespace

void answer_contradictions(NoiseFit& fit, const AllanCurve& allan) {
  if (!deviation_row(allan.type).is_allan()) return;
  if (const auto worst = worst_contradiction(fit, allan)) {
    const bool of_process = mostly_process(fit, worst->tau_s / allan.dt_s, allan.dt_s);
    if (of_process) fit.gauss_markov->sigma.status = fit.gauss_markov->tau_s.status = Status::undetermined;
    doubt(fit, of_process ? kTerms : worst->term, 0,
          fmt::format("At an averaging time of {} the fitted curve is at {}, the measured Allan deviation within "
                      "{} … {} (99.7 %): the data do not support {} there, and it is marked undetermined.",
                      duration_text(worst->tau_s), brief_text(worst->model), brief_text(worst->measured.low),
                      brief_text(worst->measured.high),
                      of_process ? "the Gauss-Markov process" : long_name(static_cast<Term>(worst->term))));
  }
  if (!fit.second_opinion || !(fit.goodness.p < 1e-3)) return;
  for (std::size_t t = 0; t < kTerms; ++t) {
    const Coefficient& first = fit.term[t];
    const std::optional<double>& second = fit.second_opinion->value[t];
    if (first.status != Status::detected || !second) continue;
    const double apart =
        std::abs(*second - *first.value) / std::hypot(fit.second_opinion->sd[t], first.relative_sd * *first.value);
    const double ratio = std::max(*second, *first.value) / std::min(*second, *first.value);
    if (apart > 3 && ratio > kRelevant)
      doubt(fit, t, *second,
            fmt::format("{} is marked undetermined: the fit does not describe the record, and the Allan curve gives {} "
                        "instead of {}.",
                        long_name(static_cast<Term>(t)), brief_text(*second), brief_text(*first.value)));
  }
}

}  // namespace libchar
