#include "libchar/characterize/curves/log_spectra.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numbers>

#include "libchar/characterize/judgement.hpp"
#include "libchar/core/error.hpp"
#include "libchar/report/text/curves_text.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

constexpr std::size_t kLogRows = 4096;
constexpr double kToneHz = 12.5;

// x: white noise and a tone; y: the same noise, missing in its second half.
std::string two_channels(const test::TemporaryFolder& folder) {
  const std::string path = (folder / "log.csv").string();
  test::NoiseSource source(kLogRows, 100, 5);
  const std::vector<double> noise = source.record(1e-2, 0, 0);
  std::ofstream out(path);
  out << "x[V],y[V]\n";
  out.precision(17);
  for (std::size_t i = 0; i < kLogRows; ++i) {
    out << noise[i] + std::sin(2 * std::numbers::pi * kToneHz * 0.01 * static_cast<double>(i)) << ",";
    if (i < kLogRows / 2) out << noise[i];
    out << "\n";
  }
  return path;
}

CharacterizeOptions at_100_hz() {
  CharacterizeOptions options;
  options.spectrum_bins = 0;
  options.wanted.lines = false;
  options.reading.rate_hz = 100;
  return options;
}

}  // namespace

TEST_CASE("log_spectra: welch of each channel, on one axis of frequency") {
  const test::TemporaryFolder folder;
  const std::string path = two_channels(folder);
  CharacterizeOptions options = at_100_hz();
  options.spectrum.segment = 512;
  const LogSpectra spectra = log_spectra(path, options);
  const Recording log = read_recording(path, options.reading);
  REQUIRE(spectra.channels.size() == 2);
  WelchOptions welch_options;
  welch_options.segment = 512;
  for (std::size_t c = 0; c < 2; ++c) {
    const Spectrum expected = welch(log.channel(c), 100, welch_options);
    CHECK(spectra.channels[c].spectrum.value == expected.value);
    CHECK(spectra.channels[c].spectrum.frequency_hz == expected.frequency_hz);
  }
  CHECK_THAT(spectra_csv(spectra), Catch::StartsWith("frequency_hz,x["));
}

TEST_CASE("log_spectra: without a segment all channels get the shortest that one of them needs") {
  const test::TemporaryFolder folder;
  CharacterizeOptions options = at_100_hz();
  options.spectrum.overlap = 0;
  const LogSpectra spectra = log_spectra(two_channels(folder), options);
  CHECK(spectra.channels[0].spectrum.segment == spectra.channels[1].spectrum.segment);
}

TEST_CASE("log_spectra: lines where they are asked for, and found where the tone is") {
  const test::TemporaryFolder folder;
  const std::string path = two_channels(folder);
  CharacterizeOptions options = at_100_hz();
  CHECK(log_spectra(path, options).channels[0].lines.empty());
  options.wanted.lines = true;
  options.spectrum_bins = 20;
  const LogSpectra spectra = log_spectra(path, options);
  REQUIRE(spectra.channels[0].lines.size() == 1);
  CHECK(spectra.channels[0].lines[0].frequency_hz == Approx(kToneHz).epsilon(0.01));
  CHECK(spectra.channels[1].lines.empty());
  CHECK(spectra.channels[0].spectrum.frequency_hz.size() <= 20);
}

TEST_CASE("log_spectra: a log without a rate, and one too short, are refused in a sentence") {
  const test::TemporaryFolder folder;
  const std::string path = two_channels(folder);
  CHECK_THROWS_WITH(log_spectra(path), Contains("rate"));
  CharacterizeOptions options = at_100_hz();
  options.spectrum.segment = 8192;
  CHECK_THROWS_WITH(log_spectra(path, options), Contains("longer than the record of 4096"));
  options.spectrum.segment = 0;
  std::ofstream(path) << "x\n1\n2\n1\n3\n2\n";
  CHECK_THROWS_WITH(log_spectra(path, options), Contains("no channel gives a spectrum: x: ") && !Contains("E0401"));
}

// As `characterize` does it: one answer, in bounded memory.
TEST_CASE("log_spectra: a record of more than a leaf has segments of 2^16 samples, a leaf a quarter") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "log.csv").string();
  CharacterizeOptions options = at_100_hz();
  const auto write = [&](std::size_t rows) {
    std::ofstream out(path);
    out << "x\n";
    for (std::size_t i = 0; i < rows; ++i) out << (i * 2654435761U) % 1009 << "\n";
  };
  constexpr std::size_t kLeaf = std::size_t{1} << 20U;
  write(kLeaf);
  CHECK(log_spectra(path, options).channels[0].spectrum.segment == kLeaf / 4);
  write(kLeaf + 1);
  const LogSpectra streamed = log_spectra(path, options);
  CHECK(streamed.channels[0].spectrum.segment == 65536);
  CHECK_THAT(streamed.notes.at(0), Contains("N/4"));
  const Recording recording = read_recording(path, options.reading);
  CHECK(log_spectra(view_of(recording), options).channels[0].spectrum.value == streamed.channels[0].spectrum.value);
  options.quarter_segments = true;
  CHECK(log_spectra(path, options).channels[0].spectrum.segment == (kLeaf + 1) / 4);
  options.quarter_segments = false;
  options.spectrum.segment = 65536;
  CHECK(log_spectra(path, options).channels[0].spectrum.value == streamed.channels[0].spectrum.value);
}

TEST_CASE("log_spectra: motion is said of a record of one leaf and of one of two") {
  for (const std::size_t rows : {std::size_t{30000}, (std::size_t{1} << 20U) + 30000}) {
    test::NoiseSource source(rows, 100, 5);
    std::vector<double> x = source.record(1e-2, 0, 0);
    CharacterizeOptions options = at_100_hz();
    Recording recording;
    recording.info.time.rate_hz = 100;
    recording.info.channels.push_back({"x", "deg/s"});
    recording.samples = {x};
    const auto moves = [&] {
      return has(findings_of(log_spectra(view_of(recording), options).channels.at(0)), "motion");
    };
    INFO(rows << " rows");
    CHECK_FALSE(moves());
    for (std::size_t i = rows / 2; i < rows / 2 + rows / 20; ++i)
      recording.samples[0][i] += 3 * std::sin(0.05 * static_cast<double>(i));
    CHECK(moves());
    options.still.search = true;
    CHECK_FALSE(moves());
  }
}

TEST_CASE("log_spectra: a channel slower than its table has an axis of its own") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "log.csv").string();
  test::NoiseSource source(kLogRows, 100, 5);
  const std::vector<double> noise = source.record(1e-2, 0, 0);
  std::ofstream out(path);
  out << "t[s],x[V],slow[V]\n";
  for (std::size_t i = 0; i < kLogRows; ++i) {
    out << static_cast<double>(i) / 100 << "," << noise[i] << ",";
    if (i % 8 == 0) out << noise[i];
    out << "\n";
  }
  out.close();
  CharacterizeOptions options;
  options.spectrum_bins = 0;
  const LogSpectra spectra = log_spectra(path, options);
  REQUIRE(spectra.channels.size() == 2);
  CHECK(spectra.channels[0].spectrum.frequency_hz.back() == Approx(50));
  CHECK(spectra.channels[1].spectrum.frequency_hz.back() == Approx(6.25));
  const std::string csv = spectra_csv(spectra);
  const std::string last = csv.substr(csv.rfind('\n', csv.size() - 2) + 1);
  CHECK(last.starts_with("50,"));
  CHECK(last.ends_with(",\n"));
}
