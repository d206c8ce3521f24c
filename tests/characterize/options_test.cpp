// Every option of the analysis below and above the memory allowed: it changes the answer alike, or
// is refused with what would do.

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/characterize/characterization.hpp"
#include "libchar/core/error.hpp"

using Catch::Contains;
using namespace libchar;

namespace {

constexpr std::uint64_t kSmall = std::uint64_t{1} << 18U;  // the record takes 937.5 KiB

Recording recording() {
  Recording made;
  made.info.channels = {{"a", "deg/s", false}, {"b", "m/s^2", false}};
  made.info.time.rate_hz = 100;
  made.samples.resize(2);
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  double walk = 0;
  for (int i = 0; i < 60000; ++i) {
    walk += 0.003 * normal(generator);
    made.samples[0].push_back(0.05 * normal(generator) + walk);
    made.samples[1].push_back(9.81 + normal(generator) + 0.5 * std::sin(0.7 * i));
  }
  return made;
}

using Change = std::function<void(CharacterizeOptions&)>;

std::vector<ChannelResult> run(const Change& change,
                               std::uint64_t memory = std::uint64_t{1} << 30U) {
  static const Recording made = recording();
  CharacterizeOptions options;
  options.spectrum.segment = 4096;
  options.memory_bytes = memory;
  change(options);
  return characterize(made, options).channels;
}

std::vector<std::uint64_t> factors(const AllanCurve& curve) {
  std::vector<std::uint64_t> m;
  for (const AllanPoint& p : curve.points) m.push_back(p.m);
  return m;
}

void same_bits(const AllanCurve& a, const AllanCurve& b) {
  CHECK(a.type == b.type);
  REQUIRE(factors(a) == factors(b));
  for (std::size_t k = 0; k < a.points.size(); ++k)
    CHECK(a.points[k].deviation == b.points[k].deviation);
}

const Change kNothing = [](CharacterizeOptions&) {};

}  // namespace

TEST_CASE("options of the spectrum mean the same of a log that streams") {
  const std::pair<const char*, Change> changes[] = {
      {"none", kNothing},
      {"sides", [](auto& o) { o.spectrum.sides = Sides::two; }},
      {"scaling", [](auto& o) { o.spectrum.scaling = Scaling::ls; }},
      {"segment", [](auto& o) { o.spectrum.segment = 1000; }},
      {"segment_s", [](auto& o) { o.spectrum.segment = 0, o.segment_s = 20; }},
      {"overlap", [](auto& o) { o.spectrum.overlap = 0.75; }},
      {"window", [](auto& o) { o.spectrum.window = Window::flat_top; }},
      {"detrend", [](auto& o) { o.spectrum.detrend = Detrend::linear; }}};
  const auto plain = run(kNothing);
  for (const auto& [name, change] : changes) {
    CAPTURE(name);
    const auto kept = run(change), streamed = run(change, kSmall);
    for (std::size_t c = 0; c < kept.size(); ++c) {
      const Spectrum &a = kept[c].spectrum, &b = streamed[c].spectrum;
      CHECK((name == std::string("none")) ==
            (a.value == plain[c].spectrum.value && a.scaling == plain[c].spectrum.scaling));
      REQUIRE(a.frequency_hz == b.frequency_hz);
      for (std::size_t k = 0; k < a.value.size(); ++k)
        CHECK(a.value[k] == Approx(b.value[k]).epsilon(1e-9));
      CHECK(a.window == b.window);
      CHECK(a.scaling == b.scaling);
      CHECK(kept[c].lines.size() == streamed[c].lines.size());
    }
  }
}

TEST_CASE(
    "limits of the averaging time hold for a log that streams, and for a long one that is kept") {
  const Change limits = [](auto& o) {
    o.allan.tau_min_s = 0.05;
    o.allan.tau_max_s = 20;
  };
  const auto kept = run(limits), streamed = run(limits, kSmall), longer = run([&](auto&o) {
                                                                   limits(o);
                                                                   o.exact_samples = 1000;
                                                                 });
  CHECK(factors(kept[0].allan) == std::vector<std::uint64_t>{8, 16, 32, 64, 128, 256, 512, 1024});
  CHECK(factors(streamed[0].allan) == factors(kept[0].allan));
  same_bits(streamed[0].allan, longer[0].allan);
  for (std::size_t k = 0; k < kept[0].allan.points.size(); ++k)
    CHECK(streamed[0].allan.points[k].deviation ==
          Approx(kept[0].allan.points[k].deviation).epsilon(0.03));
  const auto none = run([](auto& o) { o.allan.tau_min_s = 1000; }, kSmall);
  CHECK(none[0].allan.points.empty());
  REQUIRE(none[0].problems.size() == 1);
  CHECK_THAT(none[0].problems[0], Contains("no averaging time that was asked for"));
}

TEST_CASE(
    "what takes all samples is computed from all samples or refused with the memory that would "
    "do") {
  std::vector<std::pair<std::string, Change>> changes = {
      {"decade", [](auto& o) { o.allan.grid = TauGrid::decade; }},
      {"dense", [](auto& o) { o.allan.grid = TauGrid::dense, o.allan.tau_max_s = 0.3; }},
      {"list",
       [](auto& o) {
         o.allan.grid = TauGrid::list, o.allan.taus_s = {0.03, 7};
       }},
      {"full_overlap", [](auto& o) { o.full_overlap = true, o.exact_samples = 1000; }},
      {"phase", [](auto& o) { o.data = SampleKind::phase; }}};
  for (const DeviationRow& row : deviation_rows())
    if (row.type != DeviationType::oadev)
      changes.emplace_back(row.word, [&row](auto& o) { o.allan.type = row.type; });
  for (const auto& [name, change] : changes) {
    CAPTURE(name);
    std::string hint;
    try {
      run(change, kSmall);
    } catch (const Error& error) {
      CHECK(error.problem().kind == ErrorKind::usage);
      CHECK(error.problem().code == "E0701");
      CHECK_THAT(error.problem().what, Contains("938 KiB, and 256 KiB are allowed"));
      hint = error.problem().hint;
    }
    CHECK_THAT(hint, Contains("`memory_bytes` 938KiB"));
    const auto enough = run(change, 938 * 1024), kept = run(change);
    same_bits(enough[0].allan, kept[0].allan);
    CHECK(enough[0].fit->theta == kept[0].fit->theta);
    CHECK_FALSE(kept[0].allan.points.empty());
  }
}

TEST_CASE("dense times of a long record take every (m/4)-th term, and every one on request") {
  const auto dense = [](bool full) {
    return run([=](auto& o) {
      o.allan.grid = TauGrid::dense, o.allan.tau_max_s = 3, o.exact_samples = 1000;
      o.full_overlap = full;
    });
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
  for (const std::uint64_t exact : {1000UL, 100000UL}) {
    const auto plain = run([&](auto& o) { o.exact_samples = exact; });
    for (const auto& [name, change] : changes) {
      CAPTURE(name, exact);
      const auto other =
          run([&, &change = change](auto& o) { o.exact_samples = exact, change(o); });
      for (std::size_t c = 0; c < plain.size(); ++c) {
        const NoiseFit &a = *plain[c].fit, &b = *other[c].fit;
        CHECK(a.theta == b.theta);
        CHECK(a.sentences == b.sentences);
        REQUIRE(a.second_opinion.has_value());
        REQUIRE(b.second_opinion.has_value());
        CHECK(a.second_opinion->value == b.second_opinion->value);
        CHECK(a.second_opinion->goodness.chi2 == b.second_opinion->goodness.chi2);
      }
    }
  }
}

TEST_CASE("options of the fit mean the same of a log that streams") {
  const std::pair<const char*, Change> changes[] = {
      {"none", kNothing},
      {"terms",
       [](auto& o) {
         o.fit.terms = {true, false, true, false, false};
       }},
      {"threshold", [](auto& o) { o.fit.threshold = 1e9; }},
      {"remedies", [](auto& o) { o.fit.remedies = false; }},
      {"second_opinion", [](auto& o) { o.fit.second_opinion = false; }},
      {"fit alone", [](auto& o) {
         o.wanted = {false, false, false, true};
       }}};
  for (const auto& [name, change] : changes) {
    CAPTURE(name);
    const auto kept = run(change), streamed = run(change, kSmall);
    for (std::size_t c = 0; c < kept.size(); ++c) {
      const NoiseFit &a = *kept[c].fit, &b = *streamed[c].fit;
      for (std::size_t t = 0; t < kTerms; ++t) {
        CAPTURE(c, t);
        CHECK(a.term[t].status == b.term[t].status);
        REQUIRE(a.term[t].value.has_value() == b.term[t].value.has_value());
        if (a.term[t].value)
          CHECK(std::abs(*b.term[t].value / *a.term[t].value - 1) < 0.5 * a.term[t].relative_sd);
      }
      CHECK(a.second_opinion.has_value() == b.second_opinion.has_value());
      CHECK(a.second_opinion.has_value() == (name != std::string("second_opinion")));
      CHECK(kept[c].problems == streamed[c].problems);
    }
  }
}

TEST_CASE("a frequency means the same of a log that streams") {
  const Change frequency = [](auto& o) {
    o.data = SampleKind::frequency;
    o.nominal_frequency = 10;
  };
  const auto kept = run(frequency), streamed = run(frequency, kSmall);
  CHECK(streamed[1].channel.unit == kept[1].channel.unit);
  CHECK(streamed[1].allan.points[0].deviation ==
        Approx(kept[1].allan.points[0].deviation).epsilon(1e-12));
  CHECK(streamed[1].quality.mean == Approx(kept[1].quality.mean).epsilon(1e-12));
}

TEST_CASE("a spectrum without a segment says that a log that streams gets another one") {
  const Change quarter = [](auto& o) { o.spectrum.segment = 0; };
  CHECK(run(quarter)[0].spectrum.notes.empty());
  const auto streamed = run(quarter, kSmall);
  CHECK(streamed[0].problems.size() + streamed[0].spectrum.notes.size() == 1);
}
