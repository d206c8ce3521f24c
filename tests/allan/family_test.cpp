// The statistics beside plain differences: published values (fixtures/README.md), what holds of any
// record, expected values for the power-law noises, intervals, gaps.

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/error.hpp"
#include "tests/support/npy.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

const std::vector<DeviationType> kFamily = {DeviationType::pdev,    DeviationType::mtotdev, DeviationType::ttotdev,
                                            DeviationType::htotdev, DeviationType::theo1,   DeviationType::theobr,
                                            DeviationType::theoh,   DeviationType::mtie,    DeviationType::tierms};

std::vector<double> nist_suite() {
  std::vector<double> y;
  std::uint64_t n = 1234567890;
  for (int i = 0; i < 1000; ++i, n = 16807 * n % 2147483647) y.push_back(double(n) / 2147483647);
  return y;
}

/// What Stable32 distributes as PHASE.DAT: the same numbers less their mean, summed.
std::vector<double> phase_dat() {
  const std::vector<double> y = nist_suite();
  double mean = 0;
  for (const double v : y) mean += v / 1000;
  std::vector<double> x = {0};
  for (const double v : y) x.push_back(x.back() + (v - mean));
  return x;
}

struct FamilyData {
  std::vector<double> record;
  DataKind kind = DataKind::rate;
};

FamilyData family_data(const std::string& name) {
  if (name == "nist1000") return {nist_suite(), DataKind::rate};
  if (name == "nbs9") return {{892, 809, 823, 798, 671, 644, 883, 903, 677}, DataKind::rate};
  if (name == "phasedat") return {phase_dat(), DataKind::phase};
  return {test::npy(test::shared("data/clock_cs5071a_vs_hmaser_phase.npy")).column(0), DataKind::phase};
}

std::vector<double> family_taus(const Json& values, DeviationType type) {
  std::vector<double> taus;
  const double factor = type == DeviationType::theo1 ? 0.75 : 1;
  for (const auto& [m, value] : values.items()) taus.push_back(factor * std::stod(m));
  return taus;
}

/// Rows of a set met to half a unit of the last of five digits (or the fewer that are printed).
int rows_met(const Json& set) {
  const DeviationType type = *deviation_type(set["statistic"].get<std::string>());
  const FamilyData data = family_data(set["data"]);
  AllanOptions options;
  options.type = type;
  options.data = data.kind;
  options.grid = TauGrid::list;
  options.taus_s = family_taus(set["values"], type);
  options.tau_max_s = 1e9;
  AllanCurve curve = allan_deviation(data.record, 1, options);
  if (set["bias_taken_out"].get<bool>()) add_intervals(curve, {1});  // white noise
  int rows = 0;
  for (const AllanPoint& p : curve.points) {
    const auto row = set["values"].find(std::to_string(p.m));
    if (row == set["values"].end()) continue;
    INFO(set["source"] << " " << set["statistic"] << " m = " << p.m);
    const std::string printed = row->at(0);
    const double value = std::stod(printed);
    const double last_digit = std::pow(10, std::floor(std::log10(value)) - 4);
    CHECK(std::fabs(p.deviation - value) <= 0.51 * last_digit);
    CHECK(p.terms == row->at(1).get<std::uint64_t>());
    ++rows;
  }
  return rows;
}

Json published_sets() { return Json::parse(test::slurp(test::known("allan/published_family.json")))["sets"]; }

std::vector<double> normal_rates(std::size_t n, unsigned seed, double offset = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = offset + normal(random);
  return y;
}

AllanCurve family_curve(const std::vector<double>& y, DeviationType type, TauGrid grid = TauGrid::decade,
                        int threads = 0) {
  AllanOptions options;
  options.type = type;
  options.grid = grid;
  options.threads = threads;
  return allan_deviation(y, 0.5, options);
}

void family_near(const AllanCurve& a, const AllanCurve& b, double limit) {
  REQUIRE(a.points.size() == b.points.size());
  for (std::size_t k = 0; k < a.points.size(); ++k) {
    CAPTURE(name_of(a.type), a.points[k].m);
    CHECK(a.points[k].deviation == Approx(b.points[k].deviation).epsilon(limit).margin(0));
    CHECK(a.points[k].terms == b.points[k].terms);
  }
}

}  // namespace

TEST_CASE("family: published values to five digits, numbers of terms exactly") {
  int rows = 0;
  for (const Json& set : published_sets())
    if (set["data"] != "cs5071a") rows += rows_met(set);
  CHECK(rows == 165);
}

TEST_CASE("family: Stable32's MTIE and TIE rms of a caesium clock") {
  NEEDS_SHARED("data/clock_cs5071a_vs_hmaser_phase.npy");
  int rows = 0;
  for (const Json& set : published_sets())
    if (set["data"] == "cs5071a") rows += rows_met(set);
  CHECK(rows == 35 + 16 - 0);
}

TEST_CASE("family: an offset of a rate costs no digits of what is blind to it") {
  const auto y = normal_rates(3000, 1), far = normal_rates(3000, 1, 1e9);
  for (const DeviationType type : kFamily)
    if (deviation_row(type).family != DeviationFamily::interval)
      // The samples themselves are rounded to 1.2e-7 at this offset, of 3000 samples 1e-9 of a mean square.
      family_near(family_curve(y, type), family_curve(far, type), 1e-7);
  std::vector<double> coarse = y;
  for (double& v : coarse) v = std::round(v * 1024) / 1024;
  std::vector<double> coarse_far = coarse;
  for (double& v : coarse_far) v += 0x1p30;
  for (const DeviationType type : kFamily)
    if (deviation_row(type).family != DeviationFamily::interval)
      family_near(family_curve(coarse, type), family_curve(coarse_far, type), 1e-15);
}

TEST_CASE("family: a rate and its phase have the same values") {
  const auto y = normal_rates(2000, 2);
  std::vector<double> x = {0};
  for (const double v : y) x.push_back(x.back() + 0.5 * v);
  for (const DeviationType type : kFamily) {
    AllanOptions options;
    options.type = type;
    options.data = DataKind::phase;
    options.grid = TauGrid::decade;
    family_near(family_curve(y, type), allan_deviation(x, 0.5, options), 1e-11);
  }
}

TEST_CASE("family: read backwards the values are the same") {
  auto y = normal_rates(700, 3);
  for (const DeviationType type : kFamily) {
    if (type == DeviationType::pdev) continue;  // its last phase point is not used
    const AllanCurve forward = family_curve(y, type);
    std::reverse(y.begin(), y.end());
    family_near(forward, family_curve(y, type), 1e-11);
  }
}

TEST_CASE("family: the number of threads changes no bit, also where terms are spaced") {
  const auto y = normal_rates(20000, 4);
  for (const DeviationType type : kFamily) {
    AllanOptions options;
    options.type = type;
    options.work_a_point = 1 << 22;
    options.threads = 1;
    const AllanCurve one = allan_deviation(y, 1, options);
    options.threads = 3;
    const AllanCurve three = allan_deviation(y, 1, options);
    REQUIRE(one.points.size() == three.points.size());
    for (std::size_t k = 0; k < one.points.size(); ++k) CHECK(one.points[k].deviation == three.points[k].deviation);
  }
}

TEST_CASE("family: spaced terms are close to all of them, and said") {
  const auto y = normal_rates(8000, 5);
  for (const DeviationType type : {DeviationType::theo1, DeviationType::mtotdev, DeviationType::htotdev}) {
    AllanOptions options;
    options.type = type;
    options.work_a_point = 1 << 18;
    const AllanCurve spaced = allan_deviation(y, 1, options);
    options.work_a_point = 0;
    AllanCurve all = allan_deviation(y, 1, options);
    REQUIRE(spaced.notes.size() == 1);
    CHECK(spaced.notes[0].find("`full_overlap`") != std::string::npos);
    CHECK(all.notes.empty());
    add_intervals(all, {1});
    for (std::size_t k = 0; k < all.points.size(); ++k) {
      const AllanPoint& p = all.points[k];
      const double raw = p.deviation * std::sqrt(p.bias);
      CAPTURE(name_of(type), p.m);
      CHECK(std::fabs(spaced.points[k].deviation - raw) <= 0.2 * (p.ci68.high - p.ci68.low) * std::sqrt(p.bias));
    }
  }
}

TEST_CASE("family: gaps leave the terms beside them, or the longest stretch, and it is said") {
  const auto y = normal_rates(1000, 6);
  auto holed = y;
  for (const std::size_t i : {200U, 201U, 400U}) holed[i] = std::nan("");
  const std::vector<double> longest(y.begin() + 401, y.end());
  for (const DeviationType type : kFamily) {
    const AllanCurve curve = family_curve(holed, type);
    CHECK(curve.missing == 3);
    const bool one = deviation_row(type).reflected || deviation_row(type).family == DeviationFamily::theo;
    if (one) {
      family_near(curve, family_curve(longest, type), 0);
      REQUIRE_FALSE(curve.notes.empty());
      CHECK(curve.notes[0].find("longest stretch without gaps") != std::string::npos);
      CHECK(curve.used == 599);
      continue;
    }
    // At m = 1 every stretch has its own terms.
    const std::uint64_t lost = type == DeviationType::pdev ? 1 : 0;
    CHECK(curve.points[0].terms == (200 - lost) + (198 - lost) + (599 - lost));
  }
}

TEST_CASE("family: MTIE and TIE rms of a straight line, a step and an alternation") {
  const std::vector<double> line(100, 3.0);
  for (const DeviationType type : {DeviationType::mtie, DeviationType::tierms})
    for (const AllanPoint& p : family_curve(line, type).points)
      CHECK(p.deviation == Approx(3 * p.tau_s).epsilon(1e-14));
  std::vector<double> step(100, 0.0);
  step[50] = -4;
  for (const AllanPoint& p : family_curve(step, DeviationType::mtie).points) {
    CHECK(p.deviation == 2);  // 4 in units of dt
    CHECK(p.terms == 101 - p.m);
  }
  const AllanCurve rms = family_curve(step, DeviationType::tierms);
  for (const AllanPoint& p : rms.points)
    CHECK(p.deviation == Approx(2 * std::sqrt(double(std::min<std::uint64_t>(p.m, 101 - p.m)) / double(101 - p.m))));
}

TEST_CASE("family: MTIE and TIE rms have no interval, the others one that holds the value") {
  const auto y = normal_rates(2000, 7);
  for (const DeviationType type : kFamily) {
    AllanCurve curve = family_curve(y, type);
    add_intervals(curve, {0.5});
    for (const AllanPoint& p : curve.points) {
      CAPTURE(name_of(type), p.m);
      if (deviation_row(type).without_interval()) {
        CHECK(p.edf == 0);
        continue;
      }
      CHECK(p.edf >= 1);
      CHECK(p.ci95.low < p.ci68.low);
      CHECK(p.ci68.low < p.deviation);
      CHECK(p.deviation < p.ci68.high);
    }
    const AllanCurve once = curve;
    add_intervals(curve, {0.5});
    family_near(once, curve, 1e-15);  // the bias is taken out once
  }
}

namespace {

/// Rates of a power-law noise: 0 white, 1 flicker, 2 walk, 3 white phase.
std::vector<double> power_law(int kind, std::size_t n, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  if (kind == 3) {
    double before = normal(random);
    for (double& v : y) {
      const double x = normal(random);
      v = x - std::exchange(before, x);
    }
    return y;
  }
  for (double& v : y) v = normal(random);
  if (kind == 2)
    for (std::size_t i = 1; i < n; ++i) y[i] += y[i - 1];
  if (kind != 1) return y;
  std::vector<double> h(n, 1.0), out(n);
  for (std::size_t k = 1; k < n; ++k) h[k] = h[k - 1] * (double(k) - 0.5) / double(k);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k <= i; ++k) out[i] += h[k] * y[i - k];
  return out;
}

struct FamilyMoments {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double v) {
    sum += v;
    squares += v * v;
    ++count;
  }
  double mean() const { return sum / count; }
  double dof() const { return 2 * mean() * mean() / (squares / count - mean() * mean()); }
};

Mixture only_noise(int kind) {
  Mixture theta{};
  theta[static_cast<std::size_t>(kind == 0   ? Term::white
                                 : kind == 1 ? Term::flicker
                                 : kind == 2 ? Term::walk
                                             : Term::quantization)] = 1;
  return theta;
}

}  // namespace

// 600 records of 256 samples of each noise: the ratio to the Allan, modified or Hadamard variance of the same records,
// and the degrees of freedom. Expected ratios: PVAR/AVAR of the continuous noises (Vernotte 2016, table I): white
// frequency 6/5, flicker 1.22, walk 1.12 (at m = 16 the sampled noises are 1.20, 1.21, 1.11); TheoBR none.
TEST_CASE("family: simulated noises have the expected values and degrees of freedom") {
  constexpr int kRecords = 600;
  constexpr std::size_t kSamples = 256;
  struct Case {
    DeviationType type, against;
    double ratio[3];  // white, flicker, walk
    double bound;
    bool corrected;
  };
  const Case cases[] = {
      {DeviationType::pdev, DeviationType::oadev, {1.20, 1.21, 1.108}, 0.06, false},
      {DeviationType::mtotdev, DeviationType::mdev, {0.772, 0.718, 0.679}, 0.04, false},
      {DeviationType::htotdev, DeviationType::ohdev, {0.996, 0.854, 0.772}, 0.05, false},
      {DeviationType::mtotdev, DeviationType::mdev, {1.058, 1.025, 0.984}, 0.05, true},
      {DeviationType::theoh, DeviationType::oadev, {1, 1, 1}, 0.05, false},
  };
  for (int kind = 0; kind < 3; ++kind) {
    std::mt19937 random(100 + static_cast<unsigned>(kind));
    std::vector<FamilyMoments> value(std::size(cases)), plain(std::size(cases));
    std::vector<double> stated(std::size(cases));
    for (int r = 0; r < kRecords; ++r) {
      const auto y = power_law(kind, kSamples, random);
      for (std::size_t c = 0; c < std::size(cases); ++c) {
        AllanOptions options;
        options.threads = 1;
        options.grid = TauGrid::list;
        options.taus_s = {16};
        options.type = cases[c].against;
        const double against = allan_deviation(y, 1, options).points[0].deviation;
        options.type = cases[c].type;
        AllanCurve curve = allan_deviation(y, 1, options);
        const double raw = curve.points[0].deviation;
        add_intervals(curve, only_noise(kind));
        stated[c] = curve.points[0].edf;
        value[c].add(std::pow(cases[c].corrected ? curve.points[0].deviation : raw, 2));
        plain[c].add(against * against);
      }
    }
    for (std::size_t c = 0; c < std::size(cases); ++c) {
      CAPTURE(name_of(cases[c].type), kind, value[c].dof(), stated[c]);
      CHECK(value[c].mean() / plain[c].mean() == Approx(cases[c].ratio[kind]).epsilon(cases[c].bound));
      CHECK(stated[c] == Approx(value[c].dof()).epsilon(0.2));
    }
  }
}

// Its bias is taken from ratios at averaging times up to half of the record: about twenty degrees of freedom at every
// averaging time, however long the record is.
TEST_CASE("family: intervals of the bias-removed Theo1 cover at every averaging time") {
  constexpr int kRecords = 250;
  for (const std::size_t samples : {200U, 800U})
    for (int kind = 0; kind < 3; ++kind) {
      std::mt19937 random(300 + static_cast<unsigned>(kind));
      std::map<double, int> covered;
      const auto n = static_cast<double>(samples);
      AllanOptions options;
      options.type = DeviationType::theobr;
      options.grid = TauGrid::list;
      options.taus_s = {18, 0.1 * n, 0.22 * n, 0.4 * n, 0.6 * n, 0.74 * n};
      for (int r = 0; r < kRecords; ++r) {
        AllanCurve curve = allan_deviation(power_law(kind, samples, random), 1, options);
        add_intervals(curve, only_noise(kind));
        for (const AllanPoint& p : curve.points) {
          const double truth = std::sqrt(allan_variance(only_noise(kind), p.tau_s, 1));
          covered[p.tau_s] += p.ci95.low <= truth && truth <= p.ci95.high ? 1 : 0;
        }
      }
      CHECK(covered.size() == 6);
      for (const auto& [tau_s, count] : covered) {
        CAPTURE(samples, kind, tau_s, count);
        CHECK(count >= 0.88 * kRecords);
      }
    }
}

TEST_CASE("family: the bias of the total deviations stays on request, and it is said") {
  const auto y = normal_rates(500, 12);
  for (const DeviationType type : {DeviationType::mtotdev, DeviationType::ttotdev, DeviationType::htotdev}) {
    AllanOptions options;
    options.type = type;
    const AllanCurve raw = allan_deviation(y, 1, options);
    AllanCurve without = raw;
    add_intervals(without, {1});
    options.bias = AllanCurve::Bias::none;
    AllanCurve with = allan_deviation(y, 1, options);
    add_intervals(with, {1});
    for (std::size_t k = 0; k < raw.points.size(); ++k) {
      CAPTURE(name_of(type), raw.points[k].m);
      CHECK(with.points[k].deviation == raw.points[k].deviation);
      CHECK(with.points[k].bias == 1);
      CHECK(with.points[k].edf == without.points[k].edf);
      CHECK(without.points[k].deviation ==
            Approx(raw.points[k].deviation / std::sqrt(without.points[k].bias)).epsilon(1e-14));
    }
    CHECK(without.points[3].bias < 1);
    REQUIRE(with.notes.size() == 1);
    CHECK(with.notes[0].find("keep their expected bias") != std::string::npos);
  }
}

TEST_CASE("family: MTIE and TIE rms reach the length of the record") {
  const std::vector<double> line(128, 3.0);
  for (const DeviationType type : {DeviationType::mtie, DeviationType::tierms}) {
    const AllanCurve curve = family_curve(line, type, TauGrid::octave);
    CHECK(curve.points.back().m == 128);
    CHECK(curve.points.back().terms == 1);
    CHECK(curve.points.back().deviation == Approx(3 * 64));
  }
}

TEST_CASE("family: slopes of the power laws") {
  // White phase, white frequency, walk of frequency: log2 of the ratio of deviations at 64 and 16 samples, halved.
  struct Case {
    DeviationType type;
    double slope[3];
  };
  const Case cases[] = {{DeviationType::pdev, {-1.5, -0.5, 0.5}},   {DeviationType::mtotdev, {-1.5, -0.5, 0.5}},
                        {DeviationType::ttotdev, {-0.5, 0.5, 1.5}}, {DeviationType::htotdev, {-1, -0.5, 0.5}},
                        {DeviationType::theoh, {-1, -0.5, 0.5}},    {DeviationType::tierms, {0, 0.5, 1}}};
  for (int n = 0; n < 3; ++n) {
    const int kind = n == 0 ? 3 : n == 1 ? 0 : 2;
    std::mt19937 random(7);
    std::vector<FamilyMoments> at16(std::size(cases)), at64(std::size(cases));
    for (int r = 0; r < 60; ++r) {
      const auto y = power_law(kind, 4096, random);
      for (std::size_t c = 0; c < std::size(cases); ++c) {
        AllanOptions options;
        options.type = cases[c].type;
        options.grid = TauGrid::list;
        options.taus_s = {16, 64};
        const AllanCurve curve = allan_deviation(y, 1, options);
        at16[c].add(std::pow(curve.points[0].deviation, 2));
        at64[c].add(std::pow(curve.points[1].deviation, 2));
      }
    }
    for (std::size_t c = 0; c < std::size(cases); ++c) {
      CAPTURE(name_of(cases[c].type), kind);
      CHECK(std::log2(at64[c].mean() / at16[c].mean()) / 4 == Approx(cases[c].slope[n]).margin(0.06));
    }
  }
}

TEST_CASE("family: every m on request, and the even ones of Theo1") {
  const auto y = normal_rates(300, 8);
  CHECK(family_curve(y, DeviationType::oadev, TauGrid::all).points.size() == 150);
  const AllanCurve theo = family_curve(y, DeviationType::theo1, TauGrid::all);
  CHECK(theo.points.size() == 146);
  CHECK(theo.points.front().m == 10);
  CHECK(theo.points.back().m == 300);
  CHECK(theo.points.back().tau_s == Approx(112.5));  // three quarters of 150 s
  const AllanCurve both = family_curve(y, DeviationType::theoh, TauGrid::all);
  double before = 0;
  for (const AllanPoint& p : both.points) {
    CHECK(p.tau_s > before);
    before = p.tau_s;
    CHECK(p.tau_s == Approx(0.5 * double(p.m) * (p.m <= 60 ? 1 : 0.75)));
  }
  CHECK(before == Approx(112.5).margin(0.75));
}

TEST_CASE("family: what a record is too short for is refused with the number of samples") {
  for (const DeviationType type : kFamily) {
    CAPTURE(name_of(type));
    const std::uint64_t needed = deviation_row(type).span(1);
    try {
      family_curve(normal_rates(needed - 1, 1), type);
      CHECK(false);
    } catch (const Error& error) {
      CHECK(error.problem().code == "E0401");
      CHECK(error.problem().what.find("at least " + std::to_string(needed)) != std::string::npos);
    }
    CHECK_FALSE(family_curve(normal_rates(needed, 1), type).points.empty());
  }
}
