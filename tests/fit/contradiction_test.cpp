#include "libchar/fit/detail/band/contradiction.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/allan/noise_curves.hpp"

using namespace libchar;

namespace {

constexpr std::uint64_t kContradictedSamples = 100'000;

// The exact curve of a mixture, as if a record had been average.
AllanCurve curve_of(const Mixture& theta) {
  AllanCurve curve;
  curve.dt_s = 0.01;
  curve.samples = kContradictedSamples;
  for (std::uint64_t m = 1; 2 * m <= kContradictedSamples / 4; m *= 2)
    curve.points.push_back({m,
                            static_cast<double>(m) * 0.01,
                            std::sqrt(allan_variance(theta, static_cast<double>(m), 0.01)),
                            kContradictedSamples - 2 * m + 1,
                            0,
                            {},
                            {},
                            true});
  return curve;
}

NoiseFit fit_of(const Mixture& theta) {
  NoiseFit fit;
  fit.theta = theta;
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (theta[t] <= 0) continue;
    fit.term[t].status = Status::detected;
    fit.term[t].value = std::sqrt(theta[t]);
    fit.term[t].relative_sd = 0.01;
    fit.term[t].ci95 = {0.98 * std::sqrt(theta[t]), 1.02 * std::sqrt(theta[t])};
  }
  return fit;
}

}  // namespace

TEST_CASE("a fit that the Allan curve bears out is left alone") {
  const Mixture theta = {1e-4, 1e-6, 1e-8, 0, 0};
  NoiseFit fit = fit_of(theta);
  answer_contradictions(fit, curve_of(theta));
  CHECK(fit.findings.empty());
  for (std::size_t t = 0; t < 3; ++t) CHECK(fit.term[t].status == Status::detected);
}

TEST_CASE("a random walk that the Allan curve does not show is undetermined, and the reader is told where") {
  NoiseFit fit = fit_of({1e-4, 0, 1e-5, 0, 0});
  answer_contradictions(fit, curve_of({1e-4, 0, 1e-8, 0, 0}));
  REQUIRE(fit.findings.size() == 1);
  CHECK(fit[Term::walk].status == Status::undetermined);
  CHECK(fit[Term::walk].ci95.low == 0);  // it may be absent
  CHECK(fit[Term::white].status == Status::detected);
}

TEST_CASE("a second opinion far away counts only when the fit does not describe the record") {
  const Mixture theta = {1e-4, 0, 0, 0, 0};
  for (const double p : {0.5, 1e-9}) {
    NoiseFit fit = fit_of(theta);
    fit.goodness.p = p;
    fit.second_opinion.emplace();
    fit.second_opinion->value[0] = 0.5e-2;
    fit.second_opinion->sd[0] = 1e-5;
    answer_contradictions(fit, curve_of(theta));
    CHECK((fit[Term::white].status == Status::undetermined) == (p < 1e-3));
    CHECK((fit[Term::white].ci95.low <= 0.5e-2) == (p < 1e-3));  // the other value is inside
  }
}
