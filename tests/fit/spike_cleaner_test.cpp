// What is a spike and what is not: alone, in pairs and runs, at the ends; and noise of kinds that only look wild.
#include "libchar/fit/signs/spike_cleaner.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/remedies.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

using test::Record;

struct Outcome {
  Record cleaned;
  SpikeCount count;
  SpikeVerdict verdict = SpikeVerdict::none;
};

Outcome cleaned_in_pieces(const Record& y, const std::function<std::size_t(std::size_t)>& next) {
  const std::span<const double> all(y);
  SpikeScan scan;
  for (std::size_t from = 0, n = 1; from < y.size(); from += n, n = next(n))
    scan.push(all.subspan(from, std::min(n, y.size() - from)));
  SpikeCleaner cleaner(scan.scale());
  Outcome out;
  const auto keep = [&](std::span<const double> part) {
    out.cleaned.insert(out.cleaned.end(), part.begin(), part.end());
  };
  for (std::size_t from = 0, n = 1; from < y.size(); from += n, n = next(n))
    keep(cleaner.push(all.subspan(from, std::min(n, y.size() - from))));
  keep(cleaner.finish());
  out.count = cleaner.count();
  out.verdict = judge_spikes(out.count);
  return out;
}

Outcome outcome(const Record& y) {
  return cleaned_in_pieces(y, [](std::size_t) { return std::size_t{8192}; });
}

Record white(std::size_t n, std::uint64_t seed, double offset = 0) {
  test::Gaussian gauss(seed);
  Record y(n);
  for (double& value : y) value = offset + gauss();
  return y;
}

/// Student's t with an even or odd number of degrees of freedom: normal over root of chi-square.
Record student(std::size_t n, std::uint64_t seed, int dof) {
  test::Gaussian gauss(seed);
  Record y(n);
  for (double& value : y) {
    double square = 0;
    for (int i = 0; i < dof; ++i) {
      const double g = gauss();
      square += g * g;
    }
    value = gauss() / std::sqrt(square / dof);
  }
  return y;
}

struct Kind {
  const char* name;
  std::function<Record(std::size_t n, std::uint64_t seed)> make;
};

Record laplace(std::size_t n, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  Record y(n);
  for (double& value : y) value = std::log(1 - gauss.uniform()) - std::log(1 - gauss.uniform());
  return y;
}

Record autoregressive_record(std::size_t n, std::uint64_t seed) {
  Record y = white(n, seed);
  for (std::size_t t = 1; t < n; ++t) y[t] += 0.95 * y[t - 1];
  return y;
}

Record walk_record(std::size_t n, std::uint64_t seed) {
  Record y = white(n, seed);
  for (std::size_t t = 1; t < n; ++t) y[t] += y[t - 1];
  return y;
}

Record turned_by_hand(std::size_t n, std::uint64_t seed) {
  Record y = white(n, seed);
  for (std::size_t t = 0; t < n; ++t) {
    const double s = static_cast<double>(t) * 1e-3;
    y[t] += 300 * std::sin(s) + 100 * std::sin(3.7 * s) * std::sin(0.11 * s);
  }
  return y;
}

Record loud_stretches(std::size_t n, std::uint64_t seed) {
  Record y = white(n, seed);
  for (std::size_t t = 0; t < n; ++t) y[t] *= t / 300 % 40 == 3 ? 8 : 1;
  return y;
}

/// A slow drift on a coarse grid, printed with one decimal.
Record thermometer(std::size_t n, std::uint64_t seed) {
  Record y = white(n, seed);
  double level = 26;
  for (std::size_t t = 0; t < n; ++t) {
    level += 2e-3 * y[t];
    y[t] = std::round((level + 0.02 * y[n - 1 - t]) * 10) / 10;
  }
  return y;
}

Record rounded_record(std::size_t n, std::uint64_t seed) {
  Record y = white(n, seed);
  for (double& value : y) value = std::round(value / 4) * 4;
  return y;
}

Record held(std::size_t n, std::uint64_t seed) {
  Record y = white(n, seed);
  for (std::size_t t = 0; t < n; ++t) y[t] = y[t - t % 3];
  return y;
}

Record telegraph(std::size_t n, std::uint64_t seed) {
  Record y = white(n, seed);
  test::Gaussian turn(seed + 1000);
  double level = 0;
  for (double& value : y) {
    if (turn.uniform() < 0.01) level = 12 - level;
    value += level;
  }
  return y;
}

Record flicker(std::size_t n, std::uint64_t seed) { return test::NoiseSource(n, 100, seed).record(0, 1, 0); }

Record with_spikes(std::size_t n, std::uint64_t seed, double share, double size) {
  Record y = white(n, seed);
  test::Gaussian place(seed + 1000);
  for (double& value : y)
    if (place.uniform() < share) value += place.uniform() < 0.5 ? size : -size;
  return y;
}

std::uint64_t missing(const Record& y, std::size_t from, std::size_t to) {
  std::uint64_t count = 0;
  for (std::size_t t = from; t < to; ++t) count += std::isnan(y[t]);
  return count;
}

}  // namespace

TEST_CASE("spikes are found and left out, alone or nearly one in a hundred") {
  for (const double share : {0.001, 0.009}) {
    const Record y = with_spikes(100000, 5, share, 20);
    const Outcome found = outcome(y);
    INFO(share);
    CHECK(found.verdict == SpikeVerdict::spikes);
    CHECK(found.count.samples == y.size());
    std::size_t wild = 0, kept = 0;
    for (std::size_t t = 0; t < y.size(); ++t) {
      if (std::abs(y[t]) < 12) continue;
      ++wild;
      kept += !std::isnan(found.cleaned[t]);
    }
    REQUIRE(wild > 50);
    CHECK(kept <= wild / 100);
    CHECK(found.count.left_out <= wild + wild / 30);
    FitOptions options;
    options.white_top = true;
    const NoiseFit fit = fit_record(y, 1, nullptr, options);
    CHECK(fit[Term::white].value.value() == Approx(1).epsilon(3 * 0.5 / std::sqrt(5e4)));
    REQUIRE(!fit.remedies.empty());
    CHECK(fit.remedies[0].kind == "spikes");
    CHECK(fit.remedies[0].count == found.count.left_out);
  }
}

TEST_CASE("the first and the last rows, pairs and runs of wild rows") {
  const std::size_t n = 50000;
  struct Fault {
    const char* name;
    std::size_t from, count;
  };
  for (const Fault fault : {Fault{"first", 0, 1}, Fault{"first ten", 0, 10}, Fault{"second", 1, 1},
                            Fault{"pair", 20000, 2}, Fault{"ten", 8190, 10}, Fault{"sixteen", 777, 16},
                            Fault{"last", n - 1, 1}, Fault{"last but one", n - 2, 1}, Fault{"last ten", n - 10, 10}}) {
    Record y = white(n, 11, 981);  // an accelerometer at 9.81 that writes zeros
    for (std::size_t t = fault.from; t < fault.from + fault.count; ++t) y[t] = 0;
    const Outcome found = outcome(y);
    INFO(fault.name);
    CHECK(found.verdict == SpikeVerdict::spikes);
    CHECK(missing(found.cleaned, fault.from, fault.from + fault.count) == fault.count);
    CHECK(found.count.left_out == fault.count);
    CHECK(fit_record(y, 1, nullptr)[Term::white].value.value() == Approx(1).epsilon(0.015));
  }
}

TEST_CASE("a step, a loud stretch and a missing stretch are no spikes") {
  Record step = white(20000, 3);
  for (std::size_t t = 9000; t < step.size(); ++t) step[t] += 100;
  CHECK(outcome(step).verdict == SpikeVerdict::none);
  Record early = white(20000, 3);
  for (std::size_t t = 40; t < early.size(); ++t) early[t] += 100;
  CHECK(outcome(early).verdict == SpikeVerdict::none);
  Record gap = white(20000, 3);
  for (std::size_t t = 5000; t < 5400; ++t) gap[t] = std::nan("");
  const Outcome found = outcome(gap);
  CHECK(found.verdict == SpikeVerdict::none);
  CHECK(found.count.samples == 19600);
}

// 60 records a kind and length: at a rate of 1 % five or more would be called spikes in one of 3,000 such tests.
TEST_CASE("noise of other kinds has no spikes") {
  const Kind kinds[] = {{"white", [](std::size_t n, std::uint64_t s) { return white(n, s); }},
                        {"t3", [](std::size_t n, std::uint64_t s) { return student(n, s, 3); }},
                        {"t4", [](std::size_t n, std::uint64_t s) { return student(n, s, 4); }},
                        {"t5", [](std::size_t n, std::uint64_t s) { return student(n, s, 5); }},
                        {"Laplace", laplace},
                        {"AR(1)", autoregressive_record},
                        {"flicker", flicker},
                        {"walk", walk_record},
                        {"turned by hand", turned_by_hand},
                        {"loud stretches", loud_stretches},
                        {"thermometer", thermometer},
                        {"rounded", rounded_record},
                        {"held", held},
                        {"telegraph", telegraph}};
  for (const Kind& kind : kinds) {
    for (const std::size_t n : {500, 3000, 30000}) {
      int called = 0;
      for (std::uint64_t seed = 1; seed <= 60; ++seed)
        called += without_spikes(kind.make(n, seed)).answer.remedy.has_value();
      INFO(kind.name << ", " << n << " samples");
      CHECK(called <= 4);
    }
  }
}

// A phase that jumps by 20 sd of its readings is a single spike of 14 sd in a clock's rates.
TEST_CASE("a single spike among Gaussian differences is one, whatever its size") {
  for (const double size : {12.0, 18.0})
    for (const bool clock : {false, true}) {
      int called = 0;
      double sum = 0;
      constexpr int kRecords = 40;
      for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
        Record y = white(3001, seed);
        if (clock)
          for (std::size_t t = 0; t + 1 < y.size(); ++t) y[t] = (y[t + 1] - y[t]) / std::sqrt(2.0);
        y[1500] = size;
        y.pop_back();
        const DespikedRecord found = without_spikes(y);
        called += found.answer.remedy.has_value();
        if (!clock) sum += fit_record(y, 1, nullptr)[Term::white].value.value();
      }
      INFO(size << (clock ? " of a clock" : ""));
      CHECK(called >= kRecords * 9 / 10);
      if (!clock) CHECK(sum / kRecords == Approx(1).epsilon(0.01));
    }
}

TEST_CASE("heavy tails are said to be tails, and nothing is left out") {
  const Record y = student(200000, 7, 5);
  FitOptions options;
  options.white_top = true;
  const NoiseFit fit = fit_record(y, 100, nullptr, options);
  options.remedies = false;
  const NoiseFit as_is = fit_record(y, 100, nullptr, options);
  REQUIRE(!fit.findings.empty());
  CHECK(fit.findings[0].sentence.find("as in heavy-tailed noise") != std::string::npos);
  CHECK(fit[Term::white].value == as_is[Term::white].value);
}

TEST_CASE("more than one wild sample in a hundred is not cleaned, and the share is said") {
  const Record y = with_spikes(50000, 9, 0.02, 30);
  CHECK(outcome(y).verdict == SpikeVerdict::too_many);
  const NoiseFit fit = fit_record(y, 100, nullptr);
  REQUIRE(!fit.findings.empty());
  CHECK(fit.findings[0].sentence.find("2 % of the samples differ from their neighbours") == 0);
  for (const Remedy& remedy : fit.remedies) CHECK(remedy.kind != "spikes");
}

TEST_CASE("what is found does not depend on how the samples are pushed") {
  Record y = with_spikes(40000, 2, 0.003, 25);
  for (std::size_t t = 0; t < 7; ++t) y[t] = -500;
  for (std::size_t t = 9000; t < 9012; ++t) y[t] = 300;
  y[100] = y[20000] = std::nan("");
  const Outcome whole = outcome(y);
  CHECK(whole.cleaned.size() == y.size());
  const Outcome pieces = cleaned_in_pieces(y, [](std::size_t n) { return n * 5 % 911 + 1; });
  const Outcome singly = cleaned_in_pieces(y, [](std::size_t) { return std::size_t{1}; });
  for (const Outcome* other : {&pieces, &singly}) {
    REQUIRE(other->cleaned.size() == y.size());
    CHECK(other->count.left_out == whole.count.left_out);
    CHECK(other->count.log_size == whole.count.log_size);
    bool same = true;
    for (std::size_t t = 0; t < y.size(); ++t)
      same &= std::isnan(whole.cleaned[t]) ? std::isnan(other->cleaned[t]) : whole.cleaned[t] == other->cleaned[t];
    CHECK(same);
  }
}

TEST_CASE("short and empty records") {
  for (const std::size_t n : {0, 1, 2, 3, 20, 40}) {
    const Outcome found = outcome(white(n, 1));
    INFO(n);
    CHECK(found.cleaned.size() == n);
    CHECK(found.verdict == SpikeVerdict::none);
  }
  const Outcome constant = outcome(Record(1000, 3.0));
  CHECK(constant.verdict == SpikeVerdict::none);
}
