#include "libchar/characterize/characterization_view.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "libchar/characterize/compare/verification.hpp"
#include "libchar/characterize/limits.hpp"
#include "tests/report/synthetic.hpp"

using namespace libchar;

TEST_CASE("characterization view: the model stands at each point of each curve") {
  const Characterization result = test::synthetic_imu();
  const CharacterizationView view = characterization_view(result);
  REQUIRE(view.channels.size() == result.channels.size());
  for (std::size_t i = 0; i < view.channels.size(); ++i) {
    const ChannelView& v = view.channels[i];
    const ChannelResult& c = result.channels[i];
    REQUIRE(v.result == &c);
    REQUIRE(v.allan_model.has_value() == c.fit.has_value());
    CHECK(v.spectrum_ci95.size() == c.spectrum.frequency_hz.size());
    if (!c.fit) continue;
    REQUIRE(v.allan_model->values.size() == c.allan.points.size());
    REQUIRE(v.spectrum_model->values.size() == c.spectrum.frequency_hz.size());
    CHECK(v.allan_model->values[0] ==
          model_deviation(*c.fit, c.allan.type, static_cast<double>(c.allan.points[0].m), c.allan.dt_s));
    const double q = *(*c.fit)[Term::white].value;
    CHECK(v.per_sample_sd == q * std::sqrt(result.log.time.rate_hz));
    CHECK(v.noise_density_one_sided == q * std::sqrt(2.0));
  }
}

TEST_CASE("characterization view: a bin without degrees of freedom has no interval") {
  Characterization result = test::synthetic_imu();
  result.channels[0].spectrum.dof[1] = 0;
  result.channels[0].spectrum.dof[2] = 20;
  const CharacterizationView view = characterization_view(result);
  CHECK_FALSE(view.channels[0].spectrum_ci95[1]);
  REQUIRE(view.channels[0].spectrum_ci95[2]);
  CHECK(view.channels[0].spectrum_ci95[2]->low < result.channels[0].spectrum.value[2]);
  CHECK(view.channels[0].spectrum_ci95[2]->low < view.channels[0].spectrum_ci68[2]->low);
}

TEST_CASE("characterization view: the spectrum of a verification has its intervals too") {
  Characterization result = test::synthetic_imu();
  CHECK(characterization_view(result).channels[0].verification_ci95.empty());
  ChannelVerification verification;
  verification.spectrum = result.channels[1].spectrum;
  verification.sentences = {"A simulation of the model agrees."};
  result.channels[0].verification = std::make_shared<ChannelVerification>(verification);
  const CharacterizationView view = characterization_view(result);
  const auto& intervals = view.channels[0].verification_ci95;
  REQUIRE(intervals.size() == verification.spectrum.value.size());
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    REQUIRE(intervals[i].has_value() == view.channels[1].spectrum_ci95[i].has_value());
    if (intervals[i]) REQUIRE(intervals[i]->low == view.channels[1].spectrum_ci95[i]->low);
  }
}

TEST_CASE("characterization view: units in their usual spelling, and no numbers without a fit") {
  Characterization result = test::synthetic_imu();
  result.channels[0].channel.unit = "m/s^2";
  result.channels[1].fit.reset();
  const CharacterizationView view = characterization_view(result);
  CHECK(view.channels[0].unit == "m/s²");
  const ChannelView& bare = view.channels[1];
  CHECK(bare.findings.empty());
  CHECK(bare.goodness.empty());
  CHECK(bare.consumers.empty());
  CHECK(bare.read_off.empty());
  CHECK_FALSE(bare.per_sample_sd);
}

TEST_CASE("characterization view: a curve of zeros is not drawn") {
  Characterization result = test::synthetic_imu();
  for (AllanPoint& p : result.channels[0].allan.points) p.deviation = 0;
  for (double& v : result.channels[0].spectrum.value) v = 0;
  const CharacterizationView view = characterization_view(result);
  CHECK_FALSE(view.channels[0].draws_allan);
  CHECK_FALSE(view.channels[0].draws_spectrum);
  CHECK(view.channels[1].draws_allan);
  CHECK(view.channels[1].draws_spectrum);
}

TEST_CASE("characterization view: the data sheet's line is that of a sensor at its limits") {
  Characterization result = test::synthetic_imu();
  LimitReport limits;
  limits.judgements.resize(2);
  limits.judgements[0].channel = limits.judgements[1].channel = "gyr_x";
  limits.judgements[0].most = 0.01;
  limits.judgements[1].term = Term::flicker;
  limits.judgements[1].most = 0.002;
  result.limits = std::make_shared<const LimitReport>(limits);
  const CharacterizationView view = characterization_view(result);
  const auto& points = result.channels[0].allan.points;
  REQUIRE(view.channels[0].data_sheet.size() == points.size());
  const double floor = 2 * std::log(2.0) / 3.14159265358979 * 4e-6;
  const AllanPoint& late = points[points.size() - 2];
  CHECK(*view.channels[0].data_sheet[points.size() - 2] == Approx(std::sqrt(1e-4 / late.tau_s + floor)).epsilon(0.01));
  CHECK(view.channels[1].data_sheet.empty());
}
