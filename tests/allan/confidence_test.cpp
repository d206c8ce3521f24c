// Degrees of freedom and covariance against exact tables, brute force and simulation.

#include <Eigen/Core>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/shared.hpp"
#include "tests/support/table.hpp"

using namespace libchar;

namespace {

const Mixture kWhite = {1, 0, 0, 0, 0}, kFlicker = {0, 1, 0, 0, 0}, kWalk = {0, 0, 1, 0, 0};

/// A curve of octaves as the estimators would give for n samples; stride_divisor 4 as AllanPyramid.
AllanCurve octaves(std::uint64_t n, std::uint64_t divisor = 0, double dt = 1) {
  AllanCurve curve;
  curve.dt_s = dt;
  curve.samples = n;
  curve.stride_divisor = divisor;
  for (std::uint64_t m = 1; 2 * m <= n; m *= 2) {
    AllanPoint p;
    p.m = m;
    p.tau_s = double(m) * dt;
    const std::uint64_t stride = divisor ? std::max<std::uint64_t>(1, m / divisor) : 1;
    p.terms = (n - 2 * m) / stride + 1;
    p.deviation = 1;
    curve.points.push_back(p);
  }
  return curve;
}

/// Covariance of the phase combination of two terms straight from s, term by term.
double direct_covariance(const Mixture& theta, double m1, double m2, double shift, double dt) {
  const double c[3] = {1, -2, 1};
  double sum = 0;
  for (std::size_t t = 0; t < 4; ++t)
    if (theta[t] != 0)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          sum += theta[t] * c[a] * c[b] * phase_covariance(Term(t), shift + b * m2 - a * m1, dt);
  return sum / (m1 * m2);
}

/// Sum over every pair of terms, as the definition says.
Eigen::MatrixXd brute_force(const AllanCurve& curve, const Mixture& theta) {
  const auto n = static_cast<Eigen::Index>(curve.points.size());
  Eigen::MatrixXd cov(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const AllanPoint &p = curve.points[i], &q = curve.points[j];
      const double m1 = double(p.m), m2 = double(q.m);
      const double mu2 = theta[4] * p.tau_s * q.tau_s;
      const std::uint64_t sp = stride_of(curve, p), sq = stride_of(curve, q);
      std::map<std::int64_t, double> known;
      double sum = 0;
      for (std::uint64_t a = 0; a < p.terms; ++a)
        for (std::uint64_t b = 0; b < q.terms; ++b) {
          const std::int64_t shift = std::int64_t(b * sq) - std::int64_t(a * sp);
          const auto [it, fresh] = known.try_emplace(shift, 0);
          if (fresh) it->second = direct_covariance(theta, m1, m2, double(shift), curve.dt_s);
          sum += it->second * it->second + 2 * mu2 * it->second;
        }
      cov(i, j) = sum / (2 * double(p.terms) * double(q.terms));
    }
  return cov;
}

double worst_of_diagonal(const Eigen::MatrixXd& got, const Eigen::MatrixXd& truth) {
  double worst = 0;
  for (Eigen::Index i = 0; i < got.rows(); ++i)
    for (Eigen::Index j = 0; j < got.cols(); ++j)
      worst = std::max(worst, std::fabs(got(i, j) - truth(i, j)) / std::sqrt(truth(i, i) * truth(j, j)));
  return worst;
}

}  // namespace

TEST_CASE("edf identities: white 2M/3, walk M at m = 1, one term has one degree of freedom") {
  for (const std::uint64_t terms : {1ULL, 2ULL, 7ULL, 999ULL, 123456ULL, 1000000000ULL}) {
    const double m = double(terms);
    // Exactly M^2/(M + (M - 1)/2), which tends to 2M/3.
    CHECK(equivalent_dof(DeviationType::oadev, kWhite, 1, terms, 1, 0.01) ==
          Approx(m * m / (m + (m - 1) / 2)).epsilon(1e-9));
    CHECK(equivalent_dof(DeviationType::oadev, kWalk, 1, terms, 1, 0.01) == Approx(m).epsilon(1e-12));
  }
  CHECK(equivalent_dof(DeviationType::oadev, kWhite, 1, 3000000, 1, 1) == Approx(2e6).epsilon(1e-6));
  for (const auto type : {DeviationType::adev, DeviationType::oadev, DeviationType::mdev, DeviationType::ohdev})
    CHECK(equivalent_dof(type, {1, 1, 1, 1, 0}, 500, 1, 1, 1) == Approx(1).epsilon(1e-12));
}

TEST_CASE("edf of the overlapping Allan deviation against the exact table") {
  int rows = 0;
  for (const auto& row : test::table(test::known("allan/edf_oadev_discrete.csv"))) {
    if (row[0] == "N") continue;
    const Mixture& theta = row[1] == "0" ? kWhite : row[1] == "-1" ? kFlicker : kWalk;
    const double got = equivalent_dof(DeviationType::oadev, theta, std::stoull(row[2]), std::stoull(row[3]), 1, 0.1);
    INFO("N " << row[0] << " alpha " << row[1] << " m " << row[2] << " got " << got);
    CHECK(got == Approx(std::stod(row[4])).epsilon(1.5e-5));
    ++rows;
  }
  CHECK(rows > 30);
}

// The tables hold five decimals but treat the ends of the record otherwise: they differ from the sum over every pair of
// terms by up to 0.7 m/N. That sum, done independently in a few lines of Python, gives 0.462889 for white m = 1, 2
// where the table has 0.46287; we agree with the sum to 1e-9.
TEST_CASE("correlation of octaves against the tables") {
  const Eigen::MatrixXd white = allan_covariance(octaves(16384), kWhite);
  CHECK(white(0, 1) / std::sqrt(white(0, 0) * white(1, 1)) == Approx(0.46288919397005934).epsilon(1e-9));
  CHECK(white(0, 2) / std::sqrt(white(0, 0) * white(2, 2)) == Approx(0.18055441738988048).epsilon(1e-9));
  CHECK(white(1, 2) / std::sqrt(white(1, 1) * white(2, 2)) == Approx(0.5015111502043262).epsilon(1e-9));
  const std::pair<const char*, Mixture> sets[] = {{"0", kWhite}, {"-1", kFlicker}, {"-2", kWalk}};
  const AllanCovariance prepared(octaves(16384));
  for (const auto& [alpha, theta] : sets) {
    const Eigen::MatrixXd cov = prepared.at(theta);
    const auto rows = test::table(test::known(std::string("allan/corr_octave_alpha") + alpha + "_N16384.csv"));
    REQUIRE(rows.size() == 12);
    for (Eigen::Index i = 0; i < 12; ++i)
      for (Eigen::Index j = 0; j < 12; ++j) {
        INFO("alpha " << alpha << " " << i << " " << j);
        CHECK(cov(i, j) / std::sqrt(cov(i, i) * cov(j, j)) ==
              Approx(std::stod(rows[std::size_t(i)][std::size_t(j)]))
                  .margin(6e-6 + 0.7 * std::pow(2.0, double(std::max(i, j))) / 16384));
      }
  }
}

TEST_CASE("degrees of freedom of the total deviation where the others have none") {
  // SP 1065, 5.4.6: b T/tau - c, with b, c = 1.5, 0 (white), 1.17, 0.22 (flicker), 0.93, 0.36 (walk).
  const auto dof = [](const Mixture& theta, std::uint64_t m) {
    return equivalent_dof(DeviationType::totdev, theta, m, 999, 1, 1);
  };
  CHECK(dof(kWhite, 1000) == Approx(1.5).epsilon(1e-12));
  CHECK(dof(kWhite, 750) == Approx(2).epsilon(1e-12));
  CHECK(dof(kFlicker, 750) == Approx(1.168 * 4 / 3 - 0.222).epsilon(1e-12));
  CHECK(dof(kFlicker, 1000) == 1);  // never fewer
  CHECK(dof(kWalk, 750) == 1);
}

TEST_CASE("degrees of freedom of the total deviation where nothing says that it has more") {
  // Quantization gains nothing by the reflected record, and a record without noise has no shares of noise.
  const std::uint64_t samples = 1000;
  for (const Mixture& theta : {Mixture{0, 0, 0, 1, 0}, Mixture{}})
    for (const std::uint64_t m : {1ULL, 10ULL, 100ULL, 499ULL, 500ULL}) {
      CAPTURE(theta, m);
      CHECK(equivalent_dof(DeviationType::totdev, theta, m, samples - 1, 1, 1) ==
            equivalent_dof(DeviationType::oadev, theta, m, samples - 2 * m + 1, 1, 1));
    }
}

TEST_CASE("the bias of the total deviation is noted by the noise, however little of it there is") {
  AllanCurve curve;
  curve.type = DeviationType::totdev;
  curve.samples = 1000;
  curve.dt_s = 0.01;
  curve.points.resize(1);
  curve.points[0].m = 500;
  curve.points[0].tau_s = 5;
  curve.points[0].terms = 999;
  curve.points[0].deviation = 1e-6;
  const auto notes = [&](const Mixture& theta) {
    AllanCurve with_intervals = curve;
    add_intervals(with_intervals, theta);
    return with_intervals.notes;
  };
  // Half of the record: 0.481/2 of flicker noise, 0.75/2 of a walk.
  REQUIRE(notes({1e-12, 1e-12, 0, 0, 0}).size() == 1);
  CHECK_THAT(notes({1e-12, 1e-12, 0, 0, 0})[0], Catch::Contains("low by up to 24 %"));
  REQUIRE(notes({1e-12, 1e-12, 1e-15, 0, 0}).size() == 1);
  CHECK_THAT(notes({1e-12, 1e-12, 1e-15, 0, 0})[0], Catch::Contains("low by up to 38 %"));
  CHECK(notes({1e-12, 0, 0, 0, 0}).empty());
}

TEST_CASE("the covariance that is remembered is that of the curve") {
  const Mixture theta = {1, 0.1, 1e-3, 0, 0};
  const AllanCurve a = octaves(1024), b = octaves(1024, 0, 2), c = octaves(2048);
  AllanCovarianceCache cache;
  for (const AllanCurve* curve : {&a, &b, &c, &a, &b, &c})
    CHECK(cache.of(*curve)->at(theta) == allan_covariance(*curve, theta));
  CHECK(cache.of(a) == cache.of(a));
}

TEST_CASE("the covariance is remembered by several at once, none of which waits for itself") {
  std::vector<AllanCurve> curves;
  for (std::uint64_t n = 1024; n < 1024 + 200; ++n) curves.push_back(octaves(n));
  AllanCovarianceCache cache;
  std::vector<std::shared_ptr<const AllanCovariance>> made(curves.size());
  parallel::for_each(0, curves.size(), [&](std::size_t i) { made[i] = cache.of(curves[i]); });
  CHECK(std::count(made.begin(), made.end(), nullptr) == 0);
}

TEST_CASE("covariance against every pair of terms, N = 256, all five terms") {
  for (const Mixture& theta : {kWhite, kFlicker, kWalk, Mixture{0, 0, 0, 1, 0}, Mixture{1, 0.5, 0.1, 2, 0.01}})
    for (const std::uint64_t divisor : {0ULL, 4ULL}) {
      const AllanCurve curve = octaves(256, divisor, 0.5);
      CHECK(worst_of_diagonal(allan_covariance(curve, theta), brute_force(curve, theta)) * 1e12 <= 1);
    }
  AllanCurve plain = octaves(200);
  plain.type = DeviationType::adev;
  plain.points.clear();
  for (const std::uint64_t m : {1ULL, 2ULL, 4ULL, 10ULL, 20ULL, 35ULL, 40ULL}) {
    AllanPoint p;
    p.m = m;
    p.tau_s = double(m);
    p.terms = 200 / m - 1;
    plain.points.push_back(p);
  }
  const Mixture theta = {1, 0.5, 0.1, 2, 0.01};
  CHECK(worst_of_diagonal(allan_covariance(plain, theta), brute_force(plain, theta)) * 1e12 <= 1);
  // Of short times only a few terms are left, fewer than fit between two of the long ones.
  AllanCurve few = octaves(256, 1);
  for (AllanPoint& p : few.points) p.terms = std::min<std::uint64_t>(p.terms, 3 + p.m % 2);
  CHECK(worst_of_diagonal(allan_covariance(few, theta), brute_force(few, theta)) * 1e12 <= 1);
}

TEST_CASE("fast covariance against every lag, N = 20000, full overlap and stride m/4") {
  for (const std::uint64_t divisor : {0ULL, 4ULL}) {
    const AllanCurve curve = octaves(20000, divisor);
    const AllanCovariance prepared(curve);
    double worst = 0;
    for (const Mixture& theta : {kWhite, kFlicker, kWalk, Mixture{1, 0.5, 0.1, 2, 1e-6}}) {
      const Eigen::MatrixXd fast = prepared.at(theta);
      for (Eigen::Index i = 0; i < fast.rows(); ++i)
        for (Eigen::Index j = 0; j <= i; ++j) {
          const AllanPoint &p = curve.points[std::size_t(i)], &q = curve.points[std::size_t(j)];
          const auto sp = std::int64_t(stride_of(curve, p)), sq = std::int64_t(stride_of(curve, q));
          // sp is a multiple of sq: count the pairs at every lag k sq.
          const std::int64_t ratio = sp / sq, np = std::int64_t(p.terms), nq = std::int64_t(q.terms);
          double sum = 0;
          for (std::int64_t k = -(nq - 1); k <= ratio * (np - 1); ++k) {
            const std::int64_t high = std::min(np - 1, (k + nq - 1) / ratio);
            const std::int64_t low = k <= 0 ? 0 : (k + ratio - 1) / ratio;
            if (high < low) continue;
            const double r = direct_covariance(theta, double(q.m), double(p.m), double(k * sq), 1);
            sum += double(high - low + 1) * (r * r + 2 * theta[4] * p.tau_s * q.tau_s * r);
          }
          const double truth = sum / (2 * double(p.terms) * double(q.terms));
          worst = std::max(worst, std::fabs(fast(i, j) - truth) / std::sqrt(fast(i, i) * fast(j, j)));
        }
    }
    INFO("divisor " << divisor << " worst " << worst);
    CHECK(worst <= (divisor ? 1e-3 : 3e-5));
  }
}

TEST_CASE("covariance is symmetric, positive definite and consistent with the edf at N = 1e8") {
  const AllanCurve curve = octaves(100000000, 4);
  const Mixture theta = {1e-4, 1e-6, 1e-8, 1e-5, 0};
  const Eigen::MatrixXd cov = allan_covariance(curve, theta);
  CHECK(cov == cov.transpose());
  CHECK(test::positive_definite(cov));
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const AllanPoint& p = curve.points[i];
    const double mean = allan_variance(theta, double(p.m), 1);
    const double edf = equivalent_dof(DeviationType::oadev, theta, p.m, p.terms, stride_of(curve, p), 1);
    CHECK(2 * mean * mean / cov(Eigen::Index(i), Eigen::Index(i)) == Approx(edf).epsilon(1e-7));
  }
}

TEST_CASE("edf of modified, Hadamard and non-overlapping deviations against their lags one by one") {
  const Mixture theta = {1, 0.7, 0.02, 0.3, 0};
  const auto direct = [&](DeviationType type, std::uint64_t m, std::uint64_t terms, std::uint64_t stride) {
    // Terms as weights on the phase; their covariance straight from s.
    std::vector<double> w;
    if (type == DeviationType::ohdev || type == DeviationType::hdev) {
      w.assign(3 * m + 1, 0.0);
      w[0] = -1, w[m] = 3, w[2 * m] = -3, w[3 * m] = 1;
    } else if (type == DeviationType::mdev) {
      w.assign(3 * m, 0.0);
      for (std::uint64_t i = 0; i < m; ++i) w[i] += 1, w[i + m] -= 2, w[i + 2 * m] += 1;
    } else {
      w.assign(2 * m + 1, 0.0);
      w[0] = 1, w[m] = -2, w[2 * m] = 1;
    }
    const auto covariance = [&](double lag) {
      double sum = 0;
      for (std::size_t a = 0; a < w.size(); ++a)
        for (std::size_t b = 0; b < w.size(); ++b)
          if (w[a] != 0 && w[b] != 0)
            for (std::size_t t = 0; t < 4; ++t)
              sum += w[a] * w[b] * theta[t] * phase_covariance(Term(t), lag + double(b) - double(a), 1);
      return sum;
    };
    const double r0 = covariance(0);
    double sum = 0;
    for (std::uint64_t k = 1; k < terms; ++k) {
      const double r = covariance(double(k * stride)) / r0;
      sum += double(terms - k) * r * r;
    }
    return double(terms) * double(terms) / (double(terms) + 2 * sum);
  };
  struct Case {
    DeviationType type;
    std::uint64_t m, terms, stride;
  };
  for (const Case& c : {Case{DeviationType::ohdev, 1, 400, 1}, Case{DeviationType::ohdev, 8, 700, 1},
                        Case{DeviationType::ohdev, 60, 900, 1}, Case{DeviationType::hdev, 8, 90, 8},
                        Case{DeviationType::mdev, 1, 400, 1}, Case{DeviationType::mdev, 2, 400, 1},
                        Case{DeviationType::mdev, 7, 500, 1}, Case{DeviationType::adev, 5, 300, 5},
                        Case{DeviationType::oadev, 64, 900, 16}}) {
    INFO(name_of(c.type) << " m " << c.m);
    CHECK(equivalent_dof(c.type, theta, c.m, c.terms, c.stride, 1) ==
          Approx(direct(c.type, c.m, c.terms, c.stride)).epsilon(1e-6));
  }
}

TEST_CASE("edf by simulation: white noise and walk, every overlapping type, 3 %") {
  const int records = 6000;
  const std::size_t n = 256;
  for (const bool walk : {false, true})
    for (const auto type : {DeviationType::oadev, DeviationType::mdev, DeviationType::ohdev, DeviationType::totdev}) {
      std::mt19937_64 engine(7);
      std::normal_distribution<double> normal;
      std::vector<double> sum(5), square(5);
      std::vector<AllanPoint> points;
      std::vector<double> y(n);
      AllanOptions options;
      options.type = type;
      options.threads = 1;
      for (int r = 0; r < records; ++r) {
        double level = 0;
        for (double& v : y) {
          const double w = normal(engine);
          level += w;
          v = walk ? level : w;
        }
        points = allan_deviation(y, 1, options).points;
        for (std::size_t k = 0; k < 5; ++k) {
          const double v = points[k].deviation * points[k].deviation;
          sum[k] += v;
          square[k] += v * v;
        }
      }
      for (std::size_t k = 0; k < 5; ++k) {
        const double mean = sum[k] / records, variance = square[k] / records - mean * mean;
        const double edf = 2 * mean * mean / variance;
        INFO(name_of(type) << " m " << points[k].m << " walk " << walk << " simulated " << edf);
        // Standard error of a simulated edf: sqrt((2 + 12/edf)/records), times 3; total deviation is approximate: 12 %.
        const double limit = (type == DeviationType::totdev ? 0.12 : 0.0) + 3 * std::sqrt((2 + 12 / edf) / records);
        CHECK(equivalent_dof(type, walk ? kWalk : kWhite, points[k].m, points[k].terms, 1, 1) ==
              Approx(edf).epsilon(limit));
      }
    }
}

TEST_CASE("intervals of a curve: nested, finite, reliable from five degrees of freedom on, a ramp narrows them") {
  AllanCurve curve = octaves(1000);
  add_intervals(curve, {1, 0.1, 0.01, 0, 0});
  for (const auto& p : curve.points) {
    CHECK(p.ci95.low < p.ci68.low);
    CHECK(p.ci68.low < p.deviation);
    CHECK(p.ci68.high < p.ci95.high);
    CHECK(std::isfinite(p.ci95.high));
    CHECK(p.reliable == (p.edf >= 5));
  }
  CHECK(curve.points.front().reliable);
  CHECK_FALSE(curve.points.back().reliable);
  const double before = curve.points.back().edf;
  add_intervals(curve, {1, 0.1, 0.01, 0, 1});
  CHECK(curve.points.back().edf > 10 * before);
  for (const Mixture& theta :
       {Mixture{}, Mixture{0, 0, 0, 0, 1}, Mixture{1e-200, 0, 1e-190, 0, 0}, Mixture{1e200, 0, 0, 0, 1e-200}})
    for (const auto type : {DeviationType::oadev, DeviationType::mdev, DeviationType::ohdev, DeviationType::totdev}) {
      curve.type = type;
      add_intervals(curve, theta);
      for (const auto& p : curve.points) {
        CHECK(std::isfinite(p.edf));
        CHECK(p.edf >= 1);
        CHECK(std::isfinite(p.ci95.high));
        CHECK(p.ci95.low <= p.ci95.high);
      }
    }
  curve.type = DeviationType::mdev;
  CHECK_THROWS_AS(allan_covariance(curve, kWhite), Error);
}
