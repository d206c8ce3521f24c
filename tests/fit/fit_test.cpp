#include <catch2/catch.hpp>

#include "libchar/fit/noise_fit.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

TEST_CASE("a record with all three terms gives them back") {
  test::NoiseSource source(200000, 200, 1);
  const NoiseFit fit = fit_record(source.record(1e-3, 1e-2, 5e-3), 200, nullptr);
  for (const auto& c : fit.term)
    UNSCOPED_INFO(name_of(c.status)
                  << c.value.value_or(0) << " " << c.ci95.low << " " << c.ci95.high << " "
                  << c.relative_sd << " " << c.bound.value_or(0) << " "
                  << c.seconds_for_10_percent.value_or(0));
  CHECK(fit[Term::white].value.value() == Approx(1e-3).epsilon(0.015));
  CHECK(fit[Term::flicker].value.value() == Approx(1e-2).epsilon(0.03));
  CHECK(fit[Term::walk].value.value() == Approx(5e-3).epsilon(0.35));
  CHECK(fit.goodness.p > 1e-3);
}
