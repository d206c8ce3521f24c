// Wild samples on their way through a characterization: kept and streamed, of rates and of phases;
// channels that are no measurement.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/numeric/leaf_tree.hpp"

using namespace libchar;

namespace {

Recording recording_of(std::vector<std::vector<double>> columns, double rate_hz) {
  Recording recording;
  recording.info.time.rate_hz = rate_hz;
  for (std::size_t c = 0; c < columns.size(); ++c)
    recording.info.channels.push_back({"c" + std::to_string(c), "", false});
  recording.samples = std::move(columns);
  return recording;
}

std::vector<double> white_record(std::size_t n, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& value : y) value = normal(generator);
  return y;
}

const Remedy* spikes_of(const ChannelResult& channel) {
  for (const Remedy& remedy : channel.fit->remedies)
    if (remedy.kind == "spikes") return &remedy;
  return nullptr;
}

}  // namespace

TEST_CASE("spikes of a record of leaves are those of a record of one") {
  std::vector<double> y = white_record(kLeafSamples, 2), longer = white_record(2 * kLeafSamples + 7, 2);
  const auto spikes_in = [](std::vector<double>& record) {
    for (double& value : record) value += 100;
    for (std::size_t t = 77; t < record.size(); t += 501) record[t] += t % 2 == 0 ? 30 : -30;
    for (std::size_t t = 0; t < 8; ++t) record[t] = 0;
    CharacterizeOptions options;
    options.spectrum.segment = 8192;
    const ChannelResult result = characterize(recording_of({record}, 100), options).channels[0];
    REQUIRE(spikes_of(result) != nullptr);
    CHECK((*result.fit)[Term::white].value.value() == Approx(0.1).epsilon(0.005));
    return spikes_of(result)->count;
  };
  CHECK(spikes_in(y) == 2093 + 8);
  CHECK(spikes_in(longer) == 4186 + 8);
}

TEST_CASE("heavy tails of a record of leaves are left as they are") {
  std::vector<double> y = white_record(kLeafSamples + 300000, 3);
  std::mt19937_64 generator(4);
  std::chi_squared_distribution<double> square(5);
  for (double& value : y) value /= std::sqrt(square(generator) / 5);
  const Recording recording = recording_of({y}, 100);
  CharacterizeOptions with, without;
  with.spectrum.segment = without.spectrum.segment = 8192;
  without.fit.remedies = false;
  with.fit.white_top = true;
  const ChannelResult a = characterize(recording, with).channels[0], b = characterize(recording, without).channels[0];
  CHECK(spikes_of(a) == nullptr);
  REQUIRE(!a.fit->findings.empty());
  CHECK(a.fit->findings[0].sentence.find("not treated as spikes") != std::string::npos);
  CHECK((*a.fit)[Term::white].value == (*b.fit)[Term::white].value);
}

TEST_CASE("a wild reading of a phase is taken out before the phase is differenced") {
  const std::vector<double> frequency = white_record(100000, 5);
  std::vector<double> phase(1, 3);
  for (const double f : frequency) phase.push_back(phase.back() + f);
  for (const std::size_t wild : {std::size_t{0}, std::size_t{40000}, phase.size() - 1}) {
    std::vector<double> x = phase;
    x[wild] += 5e4;
    CharacterizeOptions options;
    options.data = SampleKind::phase;
    const ChannelResult result = characterize(recording_of({x}, 1), options).channels[0];
    INFO(wild);
    REQUIRE(result.fit);
    CHECK((*result.fit)[Term::white].value.value() == Approx(1).epsilon(0.007));
    REQUIRE(spikes_of(result) != nullptr);
    CHECK(spikes_of(result)->count == 1);
  }
}

TEST_CASE("missing readings of a phase leave the Allan curve and the fit where they were") {
  constexpr std::size_t kReadings = 20000;
  test::Gaussian normal(3);
  std::vector<double> whole(kReadings);
  double walk = 0;
  for (std::size_t t = 0; t < kReadings; ++t)
    whole[t] = 1234.5 * static_cast<double>(t) + 3 * normal() + (walk += 0.05 * normal());
  CharacterizeOptions options;
  options.data = SampleKind::phase;
  const auto result_of = [&](const std::vector<double>& x) {
    return characterize(recording_of({x}, 1), options).channels[0];
  };
  const ChannelResult full = result_of(whole);
  struct Row {
    std::size_t run;
    double share;
  };
  for (const Row row : {Row{1, 0.05}, Row{1, 0.3}, Row{10, 0.05}, Row{500, 0.025}}) {
    std::vector<double> x = whole;
    for (std::size_t t = row.run; t + row.run + 1 < kReadings; t += row.run)
      if (row.run == 500 ? t == 7000 : normal.uniform() < row.share)
        for (std::size_t i = 0; i < row.run; ++i) x[t + i] = std::nan("");
    const ChannelResult result = result_of(x);
    CAPTURE(row.run, row.share);
    REQUIRE(result.allan.points.size() == full.allan.points.size());
    for (std::size_t k = 0; k < full.allan.points.size(); ++k)
      if (full.allan.points[k].m <= 1024)
        CHECK(result.allan.points[k].deviation == Approx(full.allan.points[k].deviation).epsilon(0.025));
    CHECK(result.allan.notes.size() == full.allan.notes.size() + 1);
    const double q = (*full.fit)[Term::quantization].value.value();
    CHECK((*result.fit)[Term::quantization].value.value() == Approx(q).epsilon(0.02));
    CHECK((*result.fit)[Term::quantization].status == Status::detected);
  }
}

TEST_CASE(
    "the coefficients of a filled phase know of it: wider with a third missing, undetermined with more than half") {
  CharacterizeOptions options;
  options.data = SampleKind::phase;
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed)
    for (const double share : {0.3, 0.6}) {
      test::Gaussian normal(seed);
      std::vector<double> x(10000);
      double walk = 0;
      for (double& reading : x) reading = 3 * normal() + (walk += normal());
      for (std::size_t t = 1; t + 1 < x.size(); ++t)
        if (normal.uniform() < share) x[t] = std::nan("");
      const ChannelResult result = characterize(recording_of({x}, 1), options).channels[0];
      CAPTURE(seed, share);
      REQUIRE(result.fit);
      const Coefficient& q = (*result.fit)[Term::quantization];
      if (share < 0.5) held += q.ci95.low <= 3 && q.ci95.high >= 3 ? 1 : 0;
      if (share > 0.5) CHECK(q.status != Status::detected);
    }
  CHECK(held >= 10);
}

TEST_CASE("a counter gets curves and no fit, and the reason is said") {
  std::vector<double> index(5000), modulo(5000);
  for (std::size_t t = 0; t < index.size(); ++t) {
    index[t] = static_cast<double>(t);
    modulo[t] = static_cast<double>(t % 256);
  }
  const Characterization result = characterize(recording_of({index, modulo, white_record(5000, 1)}, 100), {});
  for (const std::size_t c : {std::size_t{0}, std::size_t{1}}) {
    CHECK_FALSE(result.channels[c].fit);
    REQUIRE(result.channels[c].findings.size() == 1);
    CHECK(result.channels[c].findings[0].sentence.find("no noise fit: the channel rises by 1 with") == 0);
    CHECK(!result.channels[c].allan.points.empty());
  }
  CHECK(result.channels[2].fit);
}
