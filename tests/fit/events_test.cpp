#include "libchar/fit/signs/events.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/detail/events/regression.hpp"
#include "libchar/fit/detail/events/scans.hpp"
#include "libchar/fit/detail/events/series_powers.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/spectrum/fft.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

/// E c_k^2 of a mixture for n means of `per_point` samples.
std::vector<double> mixture_powers(const Mixture& theta, std::uint64_t n, std::uint64_t per_point, double rate_hz) {
  return at_every_k(n, 1, [&](double k, std::span<double> out) {
    const std::array<double, kTerms> unit = mean_unit_powers(k, n, per_point, 1 / rate_hz);
    out[0] = std::inner_product(theta.begin(), theta.end(), unit.begin(), 0.0);
  })[0];
}

constexpr double kEventRate = 100;
constexpr std::size_t kEventSamples = 100'000;
constexpr double kQ = 5e-3, kB = 5e-3, kK = 1.5e-3, kEventSigma = 0.05;

std::vector<double> coefficients_of(const std::vector<double>& y) {
  Dct dct(y.size());
  const auto c = dct.transform(y);
  return {c.begin() + 1, c.end()};
}

EventSearch search(const std::vector<double>& y) {
  return find_events(event_series(y, kEventRate), fitted_powers(), {}, "deg/s");
}

void add_step(std::vector<double>& y, double at_s, double size) {
  for (auto t = static_cast<std::size_t>(std::lround(at_s * kEventRate)); t < y.size(); ++t) y[t] += size;
}

FitOptions all_terms() {
  FitOptions options;
  options.remedies = options.second_opinion = false;
  return options;
}

}  // namespace

TEST_CASE("events: the closed forms are the transforms of the shapes") {
  for (const std::uint64_t per_point : {1U, 7U}) {
    constexpr std::size_t n = 360;
    const SeriesGrid grid{n, per_point};
    const auto agrees = [&](const EventShape& shape, auto&& at_sample) {
      std::vector<double> y(n), column(n - 1);
      for (std::size_t i = 0; i < n * per_point; ++i)
        y[i / per_point] += at_sample(static_cast<double>(i)) / static_cast<double>(per_point);
      fill_column(shape, grid, column);
      const std::vector<double> c = coefficients_of(y);
      for (std::size_t k = 0; k < c.size(); ++k) {
        INFO("per_point " << per_point << ", k " << k + 1);
        REQUIRE(column[k] == Approx(c[k]).epsilon(1e-9).margin(1e-11));
      }
    };
    const double m = static_cast<double>(per_point);
    agrees({EventKind::step, 101}, [&](double i) { return i >= 101 * m ? 1.0 : 0.0; });
    agrees({EventKind::step, 101 + 1 / m}, [&](double i) { return i >= 101 * m + 1 ? 1.0 : 0.0; });
    agrees({EventKind::warm_up, 0, 0, 40}, [&](double i) { return std::exp(-i / (40 * m)); });
    agrees({EventKind::ramp}, [&](double i) { return i / (n * m - 1); });
    // Eleven points missing, bridged from point 100 to point 112.
    agrees({EventKind::step, 101, 11}, [&](double i) { return std::clamp((std::floor(i / m) - 100) / 12, 0.0, 1.0); });
  }
}

TEST_CASE("events: expected powers of means are those of the exact covariance") {
  constexpr std::uint64_t n = 3000, m = 20;
  const BlockMeanDct exact(n, m, 1 / kEventRate);
  for (std::size_t term = 0; term < 3; ++term) {
    Mixture theta{};
    theta[term] = 1;
    const std::vector<double> power = mixture_powers(theta, n, m, kEventRate);
    for (const std::uint64_t k : {1U, 2U, 3U, 17U, 64U, 65U, 500U, 1500U, 2998U}) {
      INFO("term " << term << ", k " << k);
      CHECK(power[k - 1] * static_cast<double>(m) == Approx(exact.mean(k)[term]).epsilon(0.005));
    }
  }
}

TEST_CASE("events: the largest of many scores passes its threshold as often as stated") {
  constexpr int kRecords = 3000, kLength = 2000;
  constexpr double kAlpha = 0.05;
  test::Gaussian gauss(4);
  for (const double correlation : {0.0, 0.9, 0.999}) {
    const double distance = std::sqrt(2 - 2 * correlation);
    const double u = rough_threshold(std::vector<double>(kLength - 1, distance), kAlpha);
    int passed = 0;
    for (int r = 0; r < kRecords; ++r) {
      double z = gauss(), largest = std::abs(z);
      for (int t = 1; t < kLength; ++t) {
        z = correlation * z + std::sqrt(1 - correlation * correlation) * gauss();
        largest = std::max(largest, std::abs(z));
      }
      passed += largest > u ? 1 : 0;
    }
    INFO("correlation " << correlation << ", threshold " << u);
    CHECK(passed > 0.03 * kRecords);
    CHECK(passed < 0.065 * kRecords);
  }
}

TEST_CASE("events: scores on a smooth curve pass their threshold as often as stated") {
  // z(x) = a cos x + b sin x on a quarter of a circle: an arc of pi/2.
  constexpr int kRecords = 20000, kSteps = 64;
  test::Gaussian gauss(5);
  const double angle = 1.5707963267949 / kSteps;
  const double u = smooth_threshold(std::vector<double>(kSteps, 2 * std::sin(angle / 2)), 0.05);
  int passed = 0;
  for (int r = 0; r < kRecords; ++r) {
    const double a = gauss(), b = gauss();
    double largest = 0;
    for (int i = 0; i <= kSteps; ++i)
      largest = std::max(largest, std::abs(a * std::cos(angle * i) + b * std::sin(angle * i)));
    passed += largest > u ? 1 : 0;
  }
  CHECK(passed > 0.04 * kRecords);
  CHECK(passed < 0.056 * kRecords);
}

TEST_CASE("events: the scan's scores are those of one regression a place") {
  constexpr std::size_t n = 630;
  test::NoiseSource source(n, kEventRate, 3);
  const std::vector<double> y = source.record(kQ, kB, 10 * kK);
  const std::vector<double> c = coefficients_of(y);
  std::vector<double> weight = mixture_powers({kQ * kQ, kB * kB, 1e2 * kK * kK, 0, 0}, n, 1, kEventRate);
  for (double& w : weight) w = 1 / w;
  for (const bool beside_ramp : {false, true}) {
    std::vector<EventShape> shapes;
    if (beside_ramp) shapes.push_back({EventKind::ramp});
    const Regression beside = regress(shapes, {n, 1}, c, weight);
    const StepScan scan = scan_steps(beside, weight, n, 8);
    for (const std::size_t at : {8U, 9U, 200U, 315U, 621U}) {
      std::vector<EventShape> with = shapes;
      with.push_back({EventKind::step, static_cast<double>(at)});
      const Regression fit = regress(with, {n, 1}, c, weight);
      INFO("ramp " << beside_ramp << ", at " << at);
      CHECK(scan.score[at] == Approx(fit.size(fit.size.size() - 1) / fit.sd(with.size() - 1)).epsilon(1e-8));
    }
    CHECK(scan.score[3] == 0);
  }
}

TEST_CASE("events: clean records have none") {
  const std::array<std::array<double, 3>, 5> scenes = {
      {{kQ, 0, 0}, {kQ, kB, 0}, {kQ, kB, kK}, {kQ, 0, 20 * kK}, {0, 0, kK}}};
  int alarms = 0;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    test::NoiseSource source(kEventSamples, kEventRate, 100 + s);
    for (int r = 0; r < 30; ++r)
      alarms += search(source.record(scenes[s][0], scenes[s][1], scenes[s][2])).events.empty() ? 0 : 1;
  }
  CHECK(alarms <= 3);  // one in a hundred of 150 records: four and more are chance once in fifteen
}

TEST_CASE("events: differences of white phase noise have none") {
  test::Gaussian gauss(46);
  for (int r = 0; r < 20; ++r) {
    std::vector<double> y(20'000);
    double before = gauss();
    for (double& value : y) {
      const double phase = gauss();
      value = phase - before;
      before = phase;
    }
    CHECK(find_events(event_series(y, 1), fitted_powers()).events.empty());
  }
}

TEST_CASE("events: a step is found, placed and sized, and K is what it was without") {
  test::NoiseSource source(kEventSamples, kEventRate, 21);
  for (const double sigmas : {1.0, -2.0, 5.0, 10.0}) {
    const std::vector<double> clean = source.record(kQ, kB, kK);
    std::vector<double> y = clean;
    const double at_s = 370 + 10 * sigmas;
    add_step(y, at_s, sigmas * kEventSigma);
    const EventSearch found = search(y);
    INFO("step of " << sigmas);
    REQUIRE(found.events.size() == 1);
    const Event& event = found.events[0];
    CHECK(event.kind == EventKind::step);
    CHECK(event.at_s == Approx(at_s).margin(1.0));
    CHECK(event.at_ci95.low <= at_s);
    CHECK(event.at_ci95.high >= at_s);
    CHECK(event.size == Approx(sigmas * kEventSigma).margin(3.5 * event.sd));
    CHECK(event.score > event.threshold);
    CHECK(found.findings[0].sentence.find("A step of") == 0);
    subtract_events(found.events, kEventRate, y);
    const NoiseFit before = fit_record(clean, kEventRate, nullptr, all_terms());
    const NoiseFit after = fit_record(y, kEventRate, nullptr, all_terms());
    const double walk = before[Term::walk].value.value_or(0);
    CHECK(std::abs(after[Term::walk].value.value_or(0) - walk) <
          1.3 * std::max(before[Term::walk].relative_sd, 0.15) * kK);
  }
}

TEST_CASE("events: two steps, up and down") {
  test::NoiseSource source(kEventSamples, kEventRate, 22);
  std::vector<double> y = source.record(kQ, kB, kK);
  add_step(y, 300, 2 * kEventSigma);
  add_step(y, 600, -2 * kEventSigma);
  const EventSearch found = search(y);
  REQUIRE(found.events.size() == 2);
  std::vector<Event> events = found.events;
  std::sort(events.begin(), events.end(), [](auto& a, auto& b) { return a.at_s < b.at_s; });
  CHECK(events[0].at_s == Approx(300).margin(1.0));
  CHECK(events[1].at_s == Approx(600).margin(1.0));
  for (const Event& event : events) CHECK(event.at_ci95.high - event.at_ci95.low < 2);
  CHECK(events[0].size == Approx(2 * kEventSigma).margin(4 * events[0].sd));
  CHECK(events[1].size == Approx(-2 * kEventSigma).margin(4 * events[1].sd));
  // what was done to the record says both in one row
  FitOptions options;
  options.second_opinion = false;
  const NoiseFit fit = fit_record(y, kEventRate, nullptr, options);
  REQUIRE(std::count_if(fit.remedies.begin(), fit.remedies.end(), [](const Remedy& r) { return r.kind == "step"; }) ==
          1);
  const Remedy& steps = *find_remedy(fit, "step");
  CHECK(steps.count == 2);
  CHECK(steps.action.find(place_text(events[0].at_s)) != std::string::npos);
  CHECK(steps.action.find(place_text(events[1].at_s)) != std::string::npos);
}

TEST_CASE("events: a warm-up has its size and time constant") {
  test::NoiseSource source(kEventSamples, kEventRate, 23);
  std::vector<double> y = source.record(kQ, kB, kK);
  for (std::size_t t = 0; t < y.size(); ++t)
    y[t] -= 8 * kEventSigma * std::exp(-static_cast<double>(t) / kEventRate / 60);
  const EventSearch found = search(y);
  REQUIRE(found.events.size() == 1);
  const Event& event = found.events[0];
  CHECK(event.kind == EventKind::warm_up);
  CHECK(event.size == Approx(-8 * kEventSigma).margin(4 * event.sd));
  CHECK(event.tau_ci95.low < 60);
  CHECK(event.tau_ci95.high > 60);
  CHECK(event.tau_s == Approx(60).epsilon(0.5));
}

TEST_CASE("events: a warm-up that outlasts the record leaves no drift and no walk behind") {
  test::NoiseSource source(kEventSamples, kEventRate, 29);
  constexpr double kLasts = kEventSamples / kEventRate;
  int one = 0, walks = 0;
  for (const double tau : {0.45 * kLasts, 0.75 * kLasts}) {
    for (int r = 0; r < 5; ++r) {
      std::vector<double> y = source.record(kQ, 0, 0);
      for (std::size_t t = 0; t < y.size(); ++t)
        y[t] += 10 * kEventSigma * std::exp(-static_cast<double>(t) / kEventRate / tau);
      const EventSearch found = search(y);
      one += found.events.size() == 1 && found.events[0].kind == EventKind::warm_up ? 1 : 0;
      FitOptions options;
      options.second_opinion = false;
      walks += fit_record(y, kEventRate, nullptr, options)[Term::walk].status == Status::detected;
    }
  }
  CHECK(one >= 9);
  CHECK(walks == 0);
}

TEST_CASE("events: a warm-up on a straight drift is both, and leaves no walk behind") {
  test::NoiseSource source(kEventSamples, kEventRate, 31);
  constexpr double kLasts = kEventSamples / kEventRate;
  const double tau = 0.42 * kLasts, size = -40 * kEventSigma, drift = 10 * kEventSigma;
  int both = 0, walks = 0, covered = 0;
  constexpr int kRecords = 10;
  for (int r = 0; r < kRecords; ++r) {
    std::vector<double> y = source.record(kQ, 0, 0);
    for (std::size_t t = 0; t < y.size(); ++t) {
      const double s = static_cast<double>(t) / kEventRate;
      y[t] += size * std::exp(-s / tau) + drift * s / kLasts;
    }
    const EventSearch found = search(y);
    both += found.events.size() == 2 ? 1 : 0;
    for (const Event& event : found.events) {
      const double true_size = event.kind == EventKind::ramp ? drift : size;
      covered += std::abs(event.size - true_size) < 2.5 * event.sd ? 1 : 0;
      UNSCOPED_INFO(event.size << " " << event.sd << " " << true_size << " " << event.tau_s);
    }
    FitOptions options;
    options.second_opinion = false;
    walks += fit_record(y, kEventRate, nullptr, options)[Term::walk].status == Status::detected;
  }
  CHECK(both >= kRecords - 1);
  CHECK(covered >= 2 * kRecords - 3);
  CHECK(walks == 0);
}

TEST_CASE("events: a ramp has a sign and an honest interval") {
  test::NoiseSource source(kEventSamples, kEventRate, 24);
  int covered = 0, told = 0;
  constexpr int kRecords = 20;
  for (int r = 0; r < kRecords; ++r) {
    std::vector<double> y = source.record(kQ, kB, kK);
    const double slope = -60 * kEventSigma / (kEventSamples / kEventRate);
    for (std::size_t t = 0; t < y.size(); ++t) y[t] += slope * static_cast<double>(t) / kEventRate;
    const EventSearch found = search(y);
    REQUIRE_FALSE(found.events.empty());
    for (const Event& event : found.events) {
      if (event.kind != EventKind::ramp) continue;
      ++told;
      covered += std::abs(event.slope - slope) < 2.5 * event.sd / (kEventSamples / kEventRate) ? 1 : 0;
    }
  }
  CHECK(told >= kRecords - 1);
  CHECK(covered >= told - 2);
}

// A drift that the slowest coefficients cannot tell from a walk was a random walk, detected, in three of four records.
TEST_CASE("events: a weak ramp over flicker is no random walk, and a random walk stays one") {
  constexpr int kRecords = 30;
  constexpr std::size_t kShort = 8192;
  constexpr double kShortT = kShort / kEventRate, kFlicker = 6 / 9.05, kWalk = 60 / kShortT;
  test::NoiseSource source(kShort, kEventRate, 21);
  int walks = 0, ramps = 0, kept = 0, held = 0;
  for (int r = 0; r < kRecords; ++r) {
    std::vector<double> y = source.record(1, kFlicker, 0);
    for (std::size_t t = 0; t < y.size(); ++t)
      y[t] += 10 * kFlicker * static_cast<double>(t) / static_cast<double>(y.size());
    walks += fit_record(y, kEventRate, nullptr)[Term::walk].status == Status::detected ? 1 : 0;
    for (std::size_t t = 0; t < y.size(); ++t)  // three times as steep it is an event
      y[t] += 20 * kFlicker * static_cast<double>(t) / static_cast<double>(y.size());
    ramps += fit_record(y, kEventRate, nullptr).events.empty() ? 0 : 1;
    y = source.record(1, 0, kWalk);
    for (std::size_t t = 0; t < y.size(); ++t)
      y[t] += 10 * kWalk * std::sqrt(kShortT) * static_cast<double>(t) / static_cast<double>(y.size());
    const Coefficient walk = fit_record(y, kEventRate, nullptr)[Term::walk];
    kept += walk.status != Status::not_detected ? 1 : 0;
    held += walk.value ? walk.ci95.low <= kWalk && kWalk <= walk.ci95.high : kWalk <= *walk.upper95;
  }
  CHECK(walks <= 3);
  CHECK(ramps >= 28);
  CHECK(kept >= 27);
  CHECK(held >= 26);  // what the drift takes of the slowest coefficients is missing in them
}

TEST_CASE("events: a step while nothing was recorded is somewhere in the gap") {
  test::NoiseSource source(kEventSamples, kEventRate, 25);
  std::vector<double> y = source.record(kQ, kB, kK);
  add_step(y, 430, 4 * kEventSigma);
  for (std::size_t t = 42000; t < 44000; ++t) y[t] = std::numeric_limits<double>::quiet_NaN();
  const EventSearch found = search(y);
  REQUIRE(found.events.size() == 1);
  CHECK(found.events[0].in_gap);
  CHECK(found.events[0].size == Approx(4 * kEventSigma).margin(4 * found.events[0].sd));
  CHECK(found.events[0].at_ci95.low <= 420.1);
  CHECK(found.events[0].at_ci95.high >= 439.9);
}

TEST_CASE("events: missing samples are no events, at the ends and in the middle") {
  test::NoiseSource source(kEventSamples, kEventRate, 28);
  constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  int alarms = 0;
  for (int r = 0; r < 10; ++r) {
    for (const auto& [from, to] : {std::pair{0, 50'000}, {90'000, 100'000}, {30'000, 60'000}}) {
      std::vector<double> y = source.record(kQ, r % 2 * kB, r % 2 * kK);
      std::fill(y.begin() + from, y.begin() + to, kMissing);
      for (double& value : y)
        if (source.gauss().uniform() < 0.1) value = kMissing;
      alarms += search(y).events.empty() ? 0 : 1;
    }
  }
  CHECK(alarms <= 1);
}

TEST_CASE("events: times are those of the record, also when it begins with missing samples") {
  test::NoiseSource source(kEventSamples, kEventRate, 29);
  std::vector<double> y = source.record(kQ, kB, kK);
  const std::vector<double> clean = y;
  add_step(y, 600, 5 * kEventSigma);
  for (std::size_t t = 20'000; t < y.size(); ++t)
    y[t] += 10 * kEventSigma * std::exp(-(static_cast<double>(t) / kEventRate - 200) / 50);
  std::fill(y.begin(), y.begin() + 20'000, std::numeric_limits<double>::quiet_NaN());
  const EventSearch found = search(y);
  REQUIRE(found.events.size() == 2);
  const bool step_first = found.events[0].kind == EventKind::step;
  CHECK(found.events[step_first ? 0 : 1].at_s == Approx(600).margin(0.5));
  CHECK(found.events[step_first ? 1 : 0].from_s == Approx(200));
  subtract_events(found.events, kEventRate, y);
  double sum = 0;
  for (std::size_t t = 20'000; t < 25'000; ++t) sum += y[t] - clean[t];
  double later = 0;
  for (std::size_t t = 65'000; t < 70'000; ++t) later += y[t] - clean[t];
  CHECK(sum / 5000 == Approx(later / 5000).margin(1.5 * kEventSigma));
}

TEST_CASE("events: a filter's slope is no event, and a step behind a filter is one") {
  // A fit of white noise, flicker and walk to the whole of such a spectrum alarmed in one record of eight.
  constexpr std::size_t kLong = 200'000, kBefore = 1000;
  test::NoiseSource source(kLong + kBefore, kEventRate, 30);
  int alarms = 0, found = 0;
  constexpr int kRecords = 20;
  for (int r = 0; r < kRecords; ++r) {
    const std::vector<double> raw = source.record(kQ, kB, kK);
    for (const double size : {0.0, 3 * kEventSigma}) {
      std::vector<double> y(kLong);
      double state = raw[0];
      for (std::size_t t = 0; t < raw.size(); ++t) {
        state += 0.25 * (raw[t] + (t >= 80'000 + kBefore ? size : 0) - state);
        if (t >= kBefore) y[t - kBefore] = state;
      }
      const EventSearch search_result = search(y);
      if (size == 0)
        alarms += search_result.events.empty() ? 0 : 1;
      else
        found += search_result.events.size() == 1 && std::abs(search_result.events[0].at_s - 800) < 1 ? 1 : 0;
    }
  }
  CHECK(alarms <= 1);
  CHECK(found >= kRecords - 1);
}

TEST_CASE("events: humps that the noise does not describe are no events") {
  test::NoiseSource source(kEventSamples, kEventRate, 26);
  int alarms = 0;
  for (int r = 0; r < 20; ++r) {
    std::vector<double> y = source.record(kQ, kB, kK);
    double x = 0, v = 0;  // a floor that sways at .56 Hz
    for (double& value : y) {
      v += -0.0352 * x - 0.02 * v / kEventRate * 100 * 0.05 + source.gauss()() * 0.3 * kEventSigma / 100;
      x += v / kEventRate * 3.5;
      value += x;
    }
    alarms += search(y).events.empty() ? 0 : 1;
  }
  CHECK(alarms <= 1);
}

TEST_CASE("events: jumps between two levels are telegraph noise, steps of unlike sizes are not") {
  test::NoiseSource source(kEventSamples, kEventRate, 27);
  std::vector<double> y = source.record(kQ, kB, kK), unlike = source.record(kQ, kB, kK);
  int jumps = 0;
  for (std::size_t t = 1; t < y.size(); ++t) {
    jumps += source.gauss().uniform() < 1 / (30 * kEventRate) ? 1 : 0;
    y[t] += jumps % 2 * 2 * kEventSigma;
  }
  const EventSearch found = search(y);
  REQUIRE(found.telegraph.has_value());
  CHECK(found.telegraph->size == Approx(2 * kEventSigma).epsilon(0.15));
  CHECK(found.telegraph->jumps >= 6);
  CHECK(found.telegraph->jumps <= jumps);
  CHECK(found.telegraph->dwell_s > 20);
  CHECK(found.findings.back().sentence.find("random telegraph noise") != std::string::npos);
  for (int i = 1; i <= 7; ++i) add_step(unlike, 120 * i, (i % 2 == 0 ? -1 : 1) * (1 + 1.5 * i) * kEventSigma);
  const EventSearch steps = search(unlike);
  CHECK(steps.events.size() >= 6);
  CHECK_FALSE(steps.telegraph.has_value());
}

TEST_CASE("events: too short a record is refused in a sentence") {
  const std::vector<double> y(40, 1.0);
  CHECK_THROWS_AS(event_series(y, kEventRate), Error);
}

TEST_CASE("events: pauses are none, and a step inside a session has its own time") {
  constexpr std::size_t kSession = 4000, kPause = 12000;
  test::Gaussian gauss(11);
  const double none = std::numeric_limits<double>::quiet_NaN();
  int invented = 0;
  std::vector<double> record;
  for (int r = 0; r < 40; ++r) {
    record.clear();
    for (int session = 0; session < 4; ++session) {
      if (session > 0) record.insert(record.end(), kPause, none);
      const double offset = 3 * session;  // levels of sessions are turn-on offsets
      for (std::size_t i = 0; i < kSession; ++i) record.push_back(offset + gauss());
    }
    invented += find_events(event_series(record, 100), fitted_powers()).events.empty() ? 0 : 1;
  }
  CHECK(invented <= 1);
  const std::size_t at = 2 * (kSession + kPause) + kSession / 2;
  for (std::size_t i = at; i < at + kSession / 2; ++i) record[i] += 0.5;
  const EventSearch found = find_events(event_series(record, 100), fitted_powers());
  REQUIRE(found.events.size() == 1);
  CHECK(found.events[0].kind == EventKind::step);
  CHECK(found.events[0].at_s == Approx(static_cast<double>(at) / 100).margin(1));
  CHECK(found.events[0].size == Approx(0.5).margin(0.15));
}

TEST_CASE("events: sessions of any length have offsets that can be told, also the last ones") {
  test::Gaussian gauss(12);
  for (const std::vector<std::size_t>& sessions :
       {std::vector<std::size_t>{4001, 2003, 1}, {4001, 1, 3, 2003}, {1, 3000, 5}, {3011, 7, 1, 1}}) {
    std::vector<double> record;
    for (const std::size_t length : sessions) {
      if (!record.empty()) record.insert(record.end(), 2000, std::numeric_limits<double>::quiet_NaN());
      const double offset = 20 * gauss();
      for (std::size_t i = 0; i < length; ++i) record.push_back(offset + gauss() + (i > 1500 ? 5 : 0));
    }
    const EventSearch found = find_events(event_series(record, 100), fitted_powers());
    INFO(sessions.size() << " sessions, the first of " << sessions[0]);
    CHECK_FALSE(found.events.empty());
    for (const Event& event : found.events) {
      CHECK(std::isfinite(event.size));
      CHECK(std::isfinite(event.sd));
    }
  }
}

TEST_CASE("events: an interval whose ends read alike is not written") {
  Event step;
  step.kind = EventKind::step;
  step.size = 3;
  step.sd = 0.01;
  step.at_s = 33.33;
  step.at_ci95 = {33.33, 33.33};
  CHECK(event_sentence(step, "V") == "A step of 3.000 ± 0.020 V at 33.33 s.");
  step.at_ci95.high = 33.4;
  CHECK(event_sentence(step, "V") == "A step of 3.000 ± 0.020 V at 33.33 s (between 33.33 and 33.4 s).");
}
