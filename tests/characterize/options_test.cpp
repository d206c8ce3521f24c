// Every option of the analysis, of a log of one leaf and of one of two: it changes the answer
// alike, or is refused with what would do.

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/characterize/characterization.hpp"
#include "libchar/core/error.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"

using Catch::Contains;
using namespace libchar;

namespace {

constexpr std::uint64_t kSmall = std::uint64_t{1} << 18U, kEnough = std::uint64_t{1} << 30U;

/// Two channels of less than a leaf, or of a little more.
Recording recording(bool is_long) {
  Recording made;
  made.info.channels = {{"a", "deg/s", false}, {"b", "m/s^2", false}};
  made.info.time.rate_hz = 100;
  made.samples.resize(2);
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  double walk = 0;
  const int rows = is_long ? 1'075'000 : 60'000;
  for (int i = 0; i < rows; ++i) {
    walk += 0.003 * normal(generator);
    made.samples[0].push_back(0.05 * normal(generator) + walk);
    made.samples[1].push_back(9.81 + normal(generator) + 0.5 * std::sin(0.7 * i));
  }
  return made;
}

using Change = std::function<void(CharacterizeOptions&)>;

std::vector<ChannelResult> run(const Change& change, std::uint64_t memory = kEnough, bool is_long = false) {
  static const Recording shorter = recording(false), longer = recording(true);
  CharacterizeOptions options;
  options.spectrum.segment = 4096;
  options.memory_bytes = memory;
  change(options);
  return characterize(is_long ? longer : shorter, options).channels;
}

std::vector<std::uint64_t> factors(const AllanCurve& curve) {
  std::vector<std::uint64_t> m;
  for (const AllanPoint& p : curve.points) m.push_back(p.m);
  return m;
}

void same_bits(const AllanCurve& a, const AllanCurve& b) {
  CHECK(a.type == b.type);
  REQUIRE(factors(a) == factors(b));
  for (std::size_t k = 0; k < a.points.size(); ++k) CHECK(a.points[k].deviation == b.points[k].deviation);
}

const Change kNothing = [](CharacterizeOptions&) {};

}  // namespace

TEST_CASE("options of the spectrum change a log of one leaf and one of two") {
  const std::pair<const char*, Change> changes[] = {
      {"sides", [](auto& o) { o.spectrum.sides = Sides::two; }},
      {"scaling", [](auto& o) { o.spectrum.scaling = Scaling::ls; }},
      {"segment", [](auto& o) { o.spectrum.segment = 1000; }},
      {"segment_s", [](auto& o) { o.spectrum.segment = 0, o.segment_s = 20; }},
      {"overlap", [](auto& o) { o.spectrum.overlap = 0.75; }},
      {"window", [](auto& o) { o.spectrum.window = Window::flat_top; }},
      {"detrend", [](auto& o) { o.spectrum.detrend = Detrend::linear; }}};
  for (const bool is_long : {false, true}) {
    const auto plain = run(kNothing, kEnough, is_long);
    for (const auto& [name, change] : changes) {
      CAPTURE(name, is_long);
      const auto changed = run(change, kEnough, is_long);
      for (std::size_t c = 0; c < changed.size(); ++c) {
        CHECK(changed[c].spectrum.value != plain[c].spectrum.value);
        CHECK(changed[c].fit->theta == plain[c].fit->theta);
      }
    }
  }
}

TEST_CASE("limits of the averaging time hold, of a short log and of one of two leaves") {
  const Change limits = [](auto& o) {
    o.allan.tau_min_s = 0.05;
    o.allan.tau_max_s = 20;
  };
  for (const bool is_long : {false, true}) {
    const auto limited = run(limits, kEnough, is_long), all = run(kNothing, kEnough, is_long);
    CHECK(factors(limited[0].allan) == std::vector<std::uint64_t>{8, 16, 32, 64, 128, 256, 512, 1024});
    for (std::size_t k = 0; k < limited[0].allan.points.size(); ++k)
      CHECK(limited[0].allan.points[k].deviation == all[0].allan.points[k + 3].deviation);
    const auto none = run([](auto& o) { o.allan.tau_min_s = 1e5; }, kEnough, is_long);
    CHECK(none[0].allan.points.empty());
    REQUIRE(none[0].findings.size() == 1);
    CHECK_THAT(none[0].findings[0].sentence, Contains("no averaging time that was asked for"));
  }
}

TEST_CASE("what takes all samples of a long log is refused with the memory that would do") {
  std::vector<std::pair<std::string, Change>> changes = {
      {"decade", [](auto& o) { o.allan.grid = TauGrid::decade; }},
      {"list",
       [](auto& o) {
         o.allan.grid = TauGrid::list, o.allan.taus_s = {0.03, 7};
       }},
      {"full_overlap", [](auto& o) { o.full_overlap = true; }},
      {"quarter", [](auto& o) { o.spectrum.segment = 0, o.quarter_segments = true; }},
      {"mdev", [](auto& o) { o.allan.type = DeviationType::mdev; }}};
  for (const auto& [name, change] : changes) {
    CAPTURE(name);
    std::string hint;
    try {
      run(change, kSmall, true);
    } catch (const Error& error) {
      CHECK(error.problem().kind == ErrorKind::usage);
      CHECK(error.problem().code == "E0701");
      CHECK_THAT(error.problem().what, Contains("16797 KiB, and 256 KiB are allowed"));
      hint = error.problem().hint;
    }
    CHECK_THAT(hint, Contains("`memory_bytes` 16797KiB"));
    const auto kept = run(change, 16797 * 1024, true), plain = run(kNothing, kEnough, true);
    CHECK(kept[0].fit->theta == plain[0].fit->theta);
    CHECK_FALSE(kept[0].allan.points.empty());
    CHECK(kept[0].spectrum.notes.empty());
  }
}

TEST_CASE("a log of one leaf is computed whole, whatever memory is allowed") {
  std::vector<std::pair<std::string, Change>> changes = {{"nothing", kNothing},
                                                         {"decade", [](auto& o) { o.allan.grid = TauGrid::decade; }},
                                                         {"phase", [](auto& o) { o.data = SampleKind::phase; }}};
  for (const DeviationRow& row : deviation_rows())
    changes.emplace_back(row.word, [&row](auto& o) { o.allan.type = row.type; });
  for (const auto& [name, change] : changes) {
    CAPTURE(name);
    const auto small = run(change, kSmall), enough = run(change);
    same_bits(small[0].allan, enough[0].allan);
    CHECK(small[0].fit->theta == enough[0].fit->theta);
  }
}

TEST_CASE("dense times of a long record take every (m/4)-th term, and every one on request") {
  const auto dense = [](bool full) {
    return run(
        [=](auto& o) {
          o.allan.grid = TauGrid::dense, o.allan.tau_max_s = 0.5;
          o.wanted.spectrum = false;
          o.full_overlap = full;
        },
        kEnough, true);
  };
  const auto few = dense(false), all = dense(true);
  CHECK(few[0].allan.stride_divisor == kPyramidStride);
  CHECK(all[0].allan.stride_divisor == 0);
  REQUIRE(few[0].allan.points.size() == all[0].allan.points.size());
  for (std::size_t k = 0; k < few[0].allan.points.size(); ++k) {
    const AllanPoint &a = few[0].allan.points[k], &b = all[0].allan.points[k];
    CAPTURE(a.m);
    CHECK((a.m < 8 ? a.terms == b.terms : a.terms < b.terms));
    CHECK(a.edf == Approx(b.edf).epsilon(0.07));
    CHECK(std::fabs(a.deviation - b.deviation) < (a.ci68.high - a.ci68.low) / 2);
  }
}

TEST_CASE("what the fit checks itself with does not depend on what is plotted") {
  const std::pair<const char*, Change> changes[] = {
      {"decade", [](auto& o) { o.allan.grid = TauGrid::decade; }},
      {"mdev", [](auto& o) { o.allan.type = DeviationType::mdev; }},
      {"list", [](auto& o) { o.allan.grid = TauGrid::list, o.allan.taus_s = {1}; }},
      {"limits", [](auto& o) { o.allan.tau_min_s = 1, o.allan.tau_max_s = 2; }},
      {"nothing fits", [](auto& o) { o.allan.tau_min_s = 1e6; }},
      {"full overlap", [](auto& o) { o.full_overlap = true; }}};
  for (const bool is_long : {false, true}) {
    int compared = 0;
    const auto plain = run(kNothing, kEnough, is_long);
    for (const auto& [name, change] : changes) {
      CAPTURE(name, is_long);
      const auto other = run(change, kEnough, is_long);
      for (std::size_t c = 0; c < plain.size(); ++c) {
        const NoiseFit &a = *plain[c].fit, &b = *other[c].fit;
        CHECK(a.theta == b.theta);
        CHECK(a.findings == b.findings);
        REQUIRE(a.second_opinion.has_value() == b.second_opinion.has_value());
        if (!a.second_opinion) continue;  // of a channel with lines
        ++compared;
        CHECK(a.second_opinion->value == b.second_opinion->value);
        CHECK(a.second_opinion->goodness.chi2 == b.second_opinion->goodness.chi2);
      }
    }
    CHECK(compared > 0);
  }
}

TEST_CASE("a spectrum without a segment is of quarters, and of a long log of 65536 samples, said") {
  const Change automatic = [](auto& o) { o.spectrum.segment = 0; };
  const auto whole = run(automatic), leaves = run(automatic, kEnough, true);
  CHECK(whole[0].spectrum.notes.empty());
  CHECK(whole[0].spectrum.segment == 15000);
  REQUIRE(leaves[0].spectrum.notes.size() == 1);
  CHECK_THAT(leaves[0].spectrum.notes[0], Contains("65536"));
}

TEST_CASE("segments that do not divide a leaf are taken from leaves in turn") {
  const Change odd = [](auto& o) { o.spectrum.segment = 5000; };
  const Spectrum leaves = run(odd, kEnough, true)[0].spectrum;
  WelchOptions options;
  options.segment = 5000;
  const Spectrum whole = log_binned(welch(recording(true).samples[0], 100, options), 400);
  REQUIRE(leaves.value.size() == whole.value.size());
  for (std::size_t k = 0; k < whole.value.size(); ++k) CHECK(leaves.value[k] == Approx(whole.value[k]).epsilon(1e-9));
}
