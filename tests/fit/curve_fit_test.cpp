#include "libchar/fit/curve/curve_fit.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/coefficient.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/curves.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

using test::numbers;
using test::rms_log10;

namespace {

DigitisedCurve allan_of(const Mixture& theta, std::optional<double> rate_hz) {
  DigitisedCurve curve;
  curve.rate_hz = rate_hz;
  for (double tau = 0.01; tau < 2e4; tau *= 2) {
    double variance = rate_hz ? allan_variance(theta, tau * *rate_hz, 1 / *rate_hz) : 0;
    for (std::size_t i = 0; !rate_hz && i < kTerms; ++i)
      variance += theta[i] * allan_asymptote(static_cast<Term>(i), tau);
    curve.x.push_back(tau);
    curve.y.push_back(std::sqrt(variance));
  }
  return curve;
}

}  // namespace

TEST_CASE("a noise-free Allan curve gives its coefficients back to nine digits") {
  const Mixture theta = {25e-6, 1e-6, 1e-8, 4e-10, 1e-14};
  for (const auto rate : {std::optional<double>{}, std::optional<double>{200.0}}) {
    const NoiseFit fit = fit_curve(allan_of(theta, rate));
    for (std::size_t i = 0; i < kTerms; ++i) {
      INFO(kTermNames[i].key);
      REQUIRE(fit.term[i].value);
      CHECK(*fit.term[i].value == Approx(std::sqrt(theta[i])).epsilon(1e-9));
    }
  }
}

TEST_CASE("terms that a noise-free curve does not have are not detected") {
  const NoiseFit fit = fit_curve(allan_of({25e-6, 0, 1e-8, 0, 0}, 100.0));
  CHECK(fit[Term::white].value.value() == Approx(5e-3).epsilon(1e-9));
  CHECK(fit[Term::walk].value.value() == Approx(1e-4).epsilon(1e-9));
  for (const Term absent : {Term::flicker, Term::quantization, Term::ramp}) {
    CHECK(fit[absent].status == Status::not_detected);
    CHECK_FALSE(fit[absent].value);
    CHECK(fit[absent].upper95.value() >= 0);
  }
}

TEST_CASE("one- and two-sided spectra, densities and roots, give the same coefficients") {
  const Mixture theta = {1e-6, 1e-4, 25e-6, 0, 0};
  for (const bool root : {false, true}) {
    for (const Sides sides : {Sides::one, Sides::two}) {
      for (const bool known : {false, true}) {
        DigitisedCurve curve;
        curve.is_allan = false;
        curve.root = root;
        curve.sides = sides;
        if (known) curve.rate_hz = 200;
        for (double f = 1e-3; f < 90; f *= 1.5) {
          double density = known ? spectrum(theta, f, 1 / 200.0) : 0;
          for (std::size_t i = 0; !known && i < 3; ++i)
            density += theta[i] * spectrum_asymptote(static_cast<Term>(i), f, 1);
          if (sides == Sides::one) density *= 2;
          curve.x.push_back(f);
          curve.y.push_back(root ? std::sqrt(density) : density);
        }
        const NoiseFit fit = fit_curve(curve);
        CHECK(fit[Term::white].value.value() == Approx(1e-3).epsilon(1e-9));
        CHECK(fit[Term::flicker].value.value() == Approx(1e-2).epsilon(1e-9));
        CHECK(fit[Term::walk].value.value() == Approx(5e-3).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("scaling a curve scales the coefficients") {
  DigitisedCurve curve = allan_of({25e-6, 1e-6, 1e-8, 0, 0}, std::nullopt);
  test::Gaussian gauss(3);
  for (double& y : curve.y) y *= std::exp(0.02 * gauss());
  const NoiseFit one = fit_curve(curve);
  for (double& y : curve.y) y *= 1e6;
  const NoiseFit million = fit_curve(curve);
  for (std::size_t i = 0; i < kTerms; ++i) {
    REQUIRE(one.term[i].status == million.term[i].status);
    if (one.term[i].value) CHECK(*million.term[i].value == Approx(1e6 * *one.term[i].value).epsilon(1e-9));
  }
}

TEST_CASE("a curve of any scale that a double holds has the digits of scale one") {
  for (const bool is_allan : {true, false})
    for (const bool root : {true, false}) {
      DigitisedCurve curve = allan_of({25e-6, 1e-6, 1e-8, 0, 0}, std::nullopt);
      curve.is_allan = is_allan;
      curve.root = root;
      const NoiseFit one = fit_curve(curve);
      for (const int octave : {-332, -300, 300, 332}) {
        const double scale = std::exp2(octave);
        DigitisedCurve other = curve;
        for (double& y : other.y) y *= root ? scale : scale * scale;
        const NoiseFit fit = fit_curve(other);
        CAPTURE(is_allan, root, octave);
        CHECK(fit.search.converged);
        for (std::size_t i = 0; i < kTerms; ++i) {
          REQUIRE(one.term[i].status == fit.term[i].status);
          if (one.term[i].value) CHECK(*fit.term[i].value == scale * *one.term[i].value);
          if (one.term[i].upper95) CHECK(*fit.term[i].upper95 == scale * *one.term[i].upper95);
          CHECK(fit.term[i].ci95.high == scale * one.term[i].ci95.high);
        }
      }
    }
}

TEST_CASE("without the length of the record, what the intervals rest on is said, and the option that states it") {
  const NoiseFit fit = fit_curve(allan_of({25e-6, 1e-6, 1e-8, 0, 0}, 100.0));
  REQUIRE(fit.findings.size() == 1);
  CHECK(fit.findings[0].sentence.find("`duration_s`") != std::string::npos);
}

TEST_CASE("with the length of the record, a curve in another unit has the same intervals") {
  DigitisedCurve curve = allan_of({25e-6, 1e-6, 1e-8, 0, 1e-12}, 100.0);
  curve.duration_s = 1e5;
  test::Gaussian gauss(3);
  for (double& y : curve.y) y *= std::exp(0.02 * gauss());
  const NoiseFit one = fit_curve(curve);
  for (double& y : curve.y) y *= 1e-6;
  const NoiseFit millionth = fit_curve(curve);
  for (std::size_t i = 0; i < kTerms; ++i) {
    REQUIRE(one.term[i].status == millionth.term[i].status);
    if (!one.term[i].value) continue;
    CHECK(*millionth.term[i].value == Approx(1e-6 * *one.term[i].value).epsilon(1e-6));
    CHECK(millionth.term[i].relative_sd == Approx(one.term[i].relative_sd).epsilon(1e-6));
  }
}

TEST_CASE("with the length of the record, white noise at long times is known as well as weights tell") {
  // Generalised least squares of one term: the variance of ln theta is 1 / (1' C^-1 1), C that of
  // the logarithms of chi-squares. The points stand where these are in the mean.
  DigitisedCurve curve;
  curve.rate_hz = 1;
  curve.duration_s = 1000;
  AllanCurve record;
  record.samples = 1000;
  const Mixture white = {4, 0, 0, 0, 0};
  for (const std::uint64_t m : {100ULL, 150ULL, 200ULL, 250ULL, 300ULL, 333ULL}) {
    AllanPoint point;
    point.m = m;
    point.tau_s = static_cast<double>(m);
    point.terms = 1000 - 2 * m + 1;
    record.points.push_back(point);
    curve.x.push_back(point.tau_s);
    curve.y.push_back(std::sqrt(allan_variance(white, point.tau_s, 1)));
  }
  Eigen::MatrixXd c = allan_covariance(record, white);
  for (Eigen::Index i = 0; i < c.rows(); ++i)
    for (Eigen::Index j = 0; j < c.cols(); ++j) {
      const double yi = curve.y[static_cast<std::size_t>(i)], yj = curve.y[static_cast<std::size_t>(j)];
      c(i, j) /= yi * yi * yj * yj;
    }
  Eigen::VectorXd wider(c.rows());
  for (Eigen::Index i = 0; i < c.rows(); ++i) {
    const LogMoments moments = chi_square_log_moments(2 / c(i, i));
    wider[i] = std::sqrt(moments.variance / c(i, i));
    curve.y[static_cast<std::size_t>(i)] *= std::exp(moments.mean / 2);
  }
  c = wider.asDiagonal() * c * wider.asDiagonal();
  const NoiseFit fit = fit_curve(curve);
  REQUIRE(fit[Term::white].value);
  CHECK(*fit[Term::white].value == Approx(2).epsilon(2e-3));
  CHECK(fit[Term::white].relative_sd == Approx(0.5 / std::sqrt(test::inverse(c).sum())).epsilon(0.05));
}

TEST_CASE("residuals that go together are fewer points, and widen the intervals") {
  const auto relative_sd = [](int period) {
    DigitisedCurve curve;
    for (int j = 0; j < 48; ++j) {
      const double tau = 0.01 * std::pow(2, 0.25 * j);
      curve.x.push_back(tau);
      curve.y.push_back(5e-3 / std::sqrt(tau) * (2 * (j % period) < period ? 1.01 : 0.99));
    }
    const NoiseFit fit = fit_curve(curve);
    REQUIRE(fit[Term::white].value);
    return fit[Term::white].relative_sd;
  };
  CHECK(relative_sd(8) > 1.4 * relative_sd(2));
}

TEST_CASE("a term that is there but barely known has an interval off zero on either side of it") {
  // Six points that scatter by 40 %: what is kept is so at 5.41, and twice the log-likelihood need only fall by 3.84.
  test::Gaussian gauss(5);
  int profiled = 0;
  for (int round = 0; round < 60; ++round) {
    DigitisedCurve curve;
    for (double tau = 0.01; tau < 2e4; tau *= 8) {
      curve.x.push_back(tau);
      curve.y.push_back(std::sqrt(25e-6 / tau + 1e-8 * tau / 3) * std::exp(0.4 * gauss()));
    }
    const NoiseFit fit = fit_curve(curve);
    for (const Coefficient& term : fit.term) {
      if (!term.profile) continue;
      ++profiled;
      CAPTURE(round, *term.value, term.ci95.low, term.ci95.high);
      CHECK(term.ci95.low > 0.1 * *term.value);
      CHECK(term.ci95.low < *term.value);
      CHECK(term.ci95.high > *term.value);
    }
  }
  CHECK(profiled > 5);
}

TEST_CASE("stated uncertainties: intervals cover, wrong ones are said to be wrong") {
  test::Gaussian gauss(5);
  int covered = 0, total = 0;
  for (int round = 0; round < 200; ++round) {
    DigitisedCurve curve = allan_of({25e-6, 4e-6, 1e-8, 0, 0}, std::nullopt);
    for (double& y : curve.y) {
      y *= std::exp(0.03 * gauss());
      curve.relative_sd.push_back(0.03);
    }
    const NoiseFit fit = fit_curve(curve);
    const std::array<double, 3> truth = {5e-3, 2e-3, 1e-4};
    for (std::size_t i = 0; i < 3; ++i) {
      REQUIRE(fit.term[i].value);
      ++total;
      covered += fit.term[i].ci95.low <= truth[i] && truth[i] <= fit.term[i].ci95.high ? 1 : 0;
    }
  }
  CHECK(covered > 0.92 * total);
  CHECK(covered < 0.985 * total);
  DigitisedCurve wrong = allan_of({25e-6, 4e-6, 1e-8, 0, 0}, std::nullopt);
  for (double& y : wrong.y) {
    y *= std::exp(0.2 * gauss());
    wrong.relative_sd.push_back(0.01);
  }
  CHECK(fit_curve(wrong).goodness.p < 1e-6);
}

TEST_CASE("a curve whose fast end is a filter's is fitted from where the terms hold") {
  test::Gaussian gauss(11);
  int left_out = 0, covered = 0;
  for (int round = 0; round < 40; ++round) {
    DigitisedCurve curve = allan_of({25e-6, 4e-6, 0, 0, 0}, std::nullopt);
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      // A low-pass of .03 s takes white noise away below it; a point is known to 1e-3·2^(i/2).
      const double sd = std::min(0.5, 1e-3 * std::exp2(0.5 * static_cast<double>(i)));
      curve.y[i] *= std::exp(sd * gauss()) / std::sqrt(1 + 0.03 / curve.x[i] * std::exp(-curve.x[i] / 0.03));
      curve.relative_sd.push_back(sd);
    }
    const NoiseFit fit = fit_curve(curve);
    left_out += fit.band.whole ? 0 : 1;
    CHECK(fit.goodness.p >= 0.02);
    REQUIRE(fit[Term::white].value);
    CHECK(fit[Term::white].status == Status::detected);
    covered += fit[Term::white].ci95.low <= 5e-3 && 5e-3 <= fit[Term::white].ci95.high;
    CHECK(fit.residuals.size() == curve.x.size());
  }
  CHECK(left_out == 40);
  INFO(covered);
  CHECK(covered >= 34);  // 95 % expected
}

TEST_CASE("a curve that no half of its points lets the terms describe is a misfit") {
  DigitisedCurve curve = allan_of({25e-6, 4e-6, 1e-8, 0, 0}, std::nullopt);
  for (std::size_t i = 0; i < curve.y.size(); ++i) {
    curve.y[i] *= std::exp(0.3 * std::sin(1.7 * static_cast<double>(i)));
    curve.relative_sd.push_back(0.01);
  }
  const NoiseFit fit = fit_curve(curve);
  CHECK(fit.goodness.p < 1e-3);
  for (const Coefficient& c : fit.term)
    if (c.value) CHECK(c.status == Status::misfit);
  REQUIRE(fit[Term::white].value);
  CHECK(fit[Term::white].relative_sd > 0.03);  // of the scatter, not of the stated 1 %
}

TEST_CASE("a curve of very many points is fitted in groups of neighbours, as well as point by point") {
  const Mixture theta = {25e-6, 1e-6, 1e-8, 0, 0};
  test::Gaussian gauss(6);
  DigitisedCurve curve;
  const std::size_t points = 20'000;
  for (std::size_t k = 0; k < points; ++k) {
    const double tau = 0.01 * std::pow(1e6, static_cast<double>(k) / static_cast<double>(points - 1));
    double variance = 0;
    for (std::size_t i = 0; i < kTerms; ++i) variance += theta[i] * allan_asymptote(static_cast<Term>(i), tau);
    curve.x.push_back(tau);
    curve.y.push_back(std::sqrt(variance) * (1 + 0.01 * gauss()));
  }
  const auto check = [&](const NoiseFit& fit) {
    CHECK(fit.residuals.size() <= 512);
    CHECK(fit.search.method.find("among 20000 points") != std::string::npos);
    for (const Term term : {Term::white, Term::flicker, Term::walk}) {
      const Coefficient& c = fit[term];
      REQUIRE(c.value);
      const double truth = std::sqrt(theta[static_cast<std::size_t>(term)]);
      // One per cent of 20 000 points, by about a third of them for each term.
      CHECK(*c.value == Approx(truth).epsilon(1e-3));
      CHECK(c.ci95.high - c.ci95.low < 2e-3 * truth);
      CHECK(c.ci95.high - c.ci95.low > 1e-4 * truth);
    }
  };
  check(fit_curve(curve));
  curve.relative_sd.assign(points, 0.01);
  const NoiseFit stated = fit_curve(curve);
  check(stated);
  CHECK(stated.goodness.p > 1e-3);
  // Evenly spaced, as a spectrum is: the slow end stays as it is.
  DigitisedCurve spectrum;
  spectrum.is_allan = false;
  spectrum.sides = Sides::two;
  spectrum.root = false;
  for (std::size_t k = 1; k <= points; ++k) {
    const double f = 1e-3 * static_cast<double>(k);
    double density = 0;
    for (std::size_t i = 0; i < kTerms; ++i) density += theta[i] * spectrum_asymptote(static_cast<Term>(i), f, 1);
    spectrum.x.push_back(f);
    spectrum.y.push_back(density);
  }
  const NoiseFit even = fit_curve(spectrum);
  CHECK(even.residuals.front().frequency_hz == 1e-3);
  CHECK(even[Term::walk].value.value() == Approx(1e-4).epsilon(1e-3));
  CHECK(even[Term::white].value.value() == Approx(5e-3).epsilon(1e-5));
}

TEST_CASE("bad curves are refused in a sentence") {
  DigitisedCurve curve = allan_of({25e-6, 1e-6, 1e-8, 0, 0}, std::nullopt);
  DigitisedCurve broken = curve;
  broken.y[3] = -1;
  CHECK_THROWS_AS(fit_curve(broken), Error);
  broken = curve;
  std::swap(broken.x[1], broken.x[2]);
  CHECK_THROWS_AS(fit_curve(broken), Error);
  broken = curve;
  broken.x.resize(3);
  broken.y.resize(3);
  CHECK_THROWS_AS(fit_curve(broken), Error);
  broken = curve;
  broken.y.pop_back();
  CHECK_THROWS_AS(fit_curve(broken), Error);
}

TEST_CASE("six real IMUs: no worse than the fit that imu_utils drew through the same points") {
  NEEDS_SHARED("oracle/allan/imu_utils_mit");
  const auto file = [](const std::string& name) {
    return numbers(test::shared("oracle/allan/imu_utils_mit/data_" + name + ".txt"));
  };
  for (const std::string imu : {"16448", "A3", "BMI160", "N3", "gx4", "xsens"}) {
    for (const std::string kind : {"acc", "gyr"}) {
      for (const std::string axis : {"x", "y", "z"}) {
        DigitisedCurve curve;
        curve.x = file(imu + "_" + kind + "_t");
        curve.y = file(imu + "_" + kind + "_" + axis);
        const std::vector<double> theirs = file(imu + "_sim_" + kind + "_" + axis);
        REQUIRE(theirs.size() == curve.y.size());
        FitOptions all;
        all.threshold = 0;
        const double ours = rms_log10(fit_curve(curve, all)), before = rms_log10(curve.y, theirs),
                     decided = rms_log10(fit_curve(curve));
        INFO(imu << " " << kind << " " << axis << ": all terms " << ours << ", decided " << decided << ", imu_utils "
                 << before);
        CHECK(ours <= before * (1 + 1e-6));
        CHECK(decided <= before * 1.03);
      }
    }
  }
}

TEST_CASE("published Allan curves of two IMUs are fitted, with and without the record length") {
  NEEDS_SHARED("data/avarcurve_navchip_published.csv");
  const std::map<std::string, std::pair<double, double>> logs = {{"navchip", {250, 3105250}},
                                                                 {"ln200", {400, 8640000}}};
  for (const auto& [name, log] : logs) {
    std::ifstream in(test::shared("data/avarcurve_" + name + "_published.csv"));
    std::map<std::string, DigitisedCurve> curves;
    std::map<std::string, std::vector<double>> relative_sd;
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
      std::istringstream row(line);
      std::string channel, cell;
      std::getline(row, channel, ',');
      std::vector<double> values;
      while (std::getline(row, cell, ',')) values.push_back(std::stod(cell));
      curves[channel].x.push_back(values[0]);
      curves[channel].y.push_back(values[2]);
      relative_sd[channel].push_back(values[3]);
    }
    REQUIRE(curves.size() == 6);
    for (auto& [channel, curve] : curves) {
      curve.rate_hz = log.first;
      const NoiseFit alone = fit_curve(curve);
      curve.duration_s = log.second / log.first;
      const NoiseFit weighted = fit_curve(curve);
      curve.duration_s = std::nullopt;
      curve.relative_sd = relative_sd[channel];
      const NoiseFit stated = fit_curve(curve);
      std::ostringstream text;
      for (const NoiseFit* fit : {&alone, &weighted}) {
        for (const Coefficient& c : fit->term) text << c.value.value_or(0) << " +- " << 100 * c.relative_sd << " %  ";
        text << "rms " << rms_log10(*fit) << " p " << fit->goodness.p << "\n";
      }
      UNSCOPED_INFO(name << " " << channel << "\n" << text.str());
      // What is known is said: a value counts as detected only where the terms describe the points
      // and it is known to 30 %.
      for (const NoiseFit* fit : {&alone, &weighted, &stated})
        for (const Coefficient& c : fit->term) {
          if (c.status == Status::detected) {
            CHECK(c.relative_sd <= 0.30);
            CHECK(fit->goodness.p >= 1e-3);
          }
          if (c.value) CHECK(c.ci95.high / *c.value < 1e3);
        }
      CHECK(alone.search.converged);
      CHECK(weighted.search.converged);
      CHECK(rms_log10(alone) < 0.13);
      CHECK(alone[Term::white].value.has_value());
    }
  }
}

TEST_CASE("curve fit: the last point, of one degree of freedom, does not cost the white noise") {
  // Overlapping Allan deviation of 655.36 s at 50 Hz, simulated (N 0.0040, B 0.0043, K 0.0014): the longest averaging
  // time has one term, here a sixth of its expectation. Its logarithm is that of a chi-square, far from normal.
  DigitisedCurve curve;
  curve.is_allan = true;
  curve.rate_hz = 50;
  curve.duration_s = 655.36;
  curve.y = {0.028384912662016183,  0.0201666242149949,    0.014336609073978795,  0.010340885477686195,
             0.007535873408079156,  0.005730703986629833,  0.0046904531606539596, 0.0038848008492038816,
             0.0038544451062532676, 0.0037902404156662586, 0.0039199454342896635, 0.004983208741737993,
             0.006349367336126262,  0.007326185593137345,  0.001430713310431877};
  for (std::size_t k = 0; k < curve.y.size(); ++k) curve.x.push_back(0.02 * std::pow(2.0, static_cast<double>(k)));
  const NoiseFit fit = fit_curve(curve);
  CHECK(fit.band.whole);
  CHECK(fit.goodness.p > 0.02);
  REQUIRE(fit[Term::white].value);
  CHECK(*fit[Term::white].value == Approx(0.0040).epsilon(0.02));
  CHECK(fit[Term::white].status == Status::detected);
}
