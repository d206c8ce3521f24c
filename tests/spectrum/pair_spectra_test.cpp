// Cross spectra, coherence, median averages and spectrograms: scipy's values, what holds of any record, bad input.

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "libchar/core/document/json.hpp"
#include "libchar/core/error.hpp"
#include "libchar/spectrum/welch.hpp"
#include "tests/support/code_of.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

struct SuitePair {
  std::vector<double> x, y;
};

/// The signals of fixtures/known/spectrum/make.py.
SuitePair suite_pair() {
  std::vector<double> u;
  std::uint64_t n = 1234567890;
  for (int i = 0; i < 2000; ++i, n = 16807 * n % 2147483647) u.push_back(double(n) / 2147483647);
  SuitePair pair;
  for (std::size_t i = 0; i < 1000; ++i) {
    pair.x.push_back(u[i]);
    pair.y.push_back(0.5 * u[(i + 998) % 1000] + u[1000 + i]);
  }
  return pair;
}

WelchOptions segments_of_128() {
  WelchOptions options;
  options.segment = 128;
  return options;
}

Json scipy_values() { return Json::parse(test::slurp(test::known("spectrum/pair_spectra.json"))); }

void check_list(const std::vector<double>& found, const Json& known, double limit, bool edges) {
  REQUIRE(found.size() == known.size());
  double largest = 0;
  for (const Json& value : known) largest = std::max(largest, std::fabs(value.get<double>()));
  for (std::size_t k = edges ? 0 : 1; k + (edges ? 0 : 1) < found.size(); ++k) {
    CAPTURE(k);
    CHECK(std::fabs(found[k] - known[k].get<double>()) <= limit * largest);
  }
}

std::vector<double> normals(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> out(n);
  for (double& v : out) v = normal(random);
  return out;
}

}  // namespace

TEST_CASE("pair spectra: scipy's cross spectrum, coherence, medians and spectrogram to 1e-12") {
  const SuitePair pair = suite_pair();
  const Json known = scipy_values();
  const CrossSpectrum cross = cross_spectrum(pair.x, pair.y, 50, segments_of_128());
  CHECK(cross.segments == 14);
  check_list(cross.frequency_hz, known["frequency_hz"], 1e-15, true);
  std::vector<double> real, imaginary;
  for (const auto& value : cross.density) {
    real.push_back(value.real());
    imaginary.push_back(value.imag());
  }
  check_list(real, known["cross_real"], 1e-12, true);
  check_list(imaginary, known["cross_imaginary"], 1e-12, true);
  check_list(cross.coherence, known["coherence"], 1e-11, true);
  check_list(median_welch(pair.x, 50, segments_of_128()).value, known["median"], 1e-12, true);
  const std::vector<double> shorter(pair.x.begin(), pair.x.begin() + 832);
  const Spectrum even = median_welch(shorter, 50, segments_of_128());
  CHECK(even.segments == 12);
  check_list(even.value, known["median_even"], 1e-12, true);
  const Spectrogram gram = spectrogram(pair.x, 50, segments_of_128());
  check_list(gram.time_s, known["time_s"], 1e-15, true);
  check_list(gram.frequency_hz, known["frequency_hz"], 1e-15, true);
  check_list(gram.value[3], known["spectrogram_3"], 1e-12, true);
}

TEST_CASE("pair spectra: a channel with itself is coherent, scaled and delayed too") {
  const auto x = normals(4096, 1);
  std::vector<double> y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = -3 * x[i] + 7;
  const CrossSpectrum cross = cross_spectrum(x, y, 100, segments_of_128());
  const Spectrum plain = welch(x, 100, segments_of_128());
  for (std::size_t k = 1; k < cross.coherence.size(); ++k) {
    CHECK(cross.coherence[k] == Approx(1).margin(1e-12));
    CHECK(cross.coherence_unbiased[k] == Approx(1).margin(1e-12));
    CHECK(std::fabs(std::arg(cross.density[k])) == Approx(3.14159265358979).margin(1e-9));
    CHECK(cross.first[k] == Approx(plain.value[k]).epsilon(1e-12));
    CHECK(cross.second[k] == Approx(9 * plain.value[k]).epsilon(1e-9));
    CHECK(cross.phase_sd_rad[k] < 1e-5);
  }
}

TEST_CASE("pair spectra: the other order conjugates, and a mean does not count") {
  const auto x = normals(3000, 2), y = normals(3000, 3);
  const CrossSpectrum a = cross_spectrum(x, y, 10, segments_of_128()), b = cross_spectrum(y, x, 10, segments_of_128());
  auto shifted = x;
  for (double& v : shifted) v += 1e6;
  const CrossSpectrum c = cross_spectrum(shifted, y, 10, segments_of_128());
  for (std::size_t k = 0; k < a.density.size(); ++k) {
    CHECK(a.density[k] == std::conj(b.density[k]));
    CHECK(a.coherence[k] == b.coherence[k]);
    CHECK(std::abs(a.density[k] - c.density[k]) <= 1e-9);
  }
}

TEST_CASE("pair spectra: of independent channels 5 % of the bins are called significant, mean unbiased") {
  double above = 0, bins = 0, mean = 0, unbiased = 0;
  CrossSpectrum cross;
  for (unsigned seed = 0; seed < 40; ++seed) {
    cross = cross_spectrum(normals(4096, 100 + 2 * seed), normals(4096, 101 + 2 * seed), 1, segments_of_128());
    for (std::size_t k = 2; k + 2 < cross.coherence.size(); ++k) {
      above += cross.coherence[k] > cross.significant_coherence ? 1 : 0;
      mean += cross.coherence[k];
      // Without the bound at zero, which would be a bias of its own.
      unbiased += (cross.effective_segments * cross.coherence[k] - 1) / (cross.effective_segments - 1);
      ++bins;
    }
  }
  CHECK(above / bins == Approx(0.05).margin(0.015));
  CHECK(mean / bins == Approx(1 / cross.effective_segments).epsilon(0.06));
  CHECK(unbiased / bins == Approx(0).margin(0.002));
}

TEST_CASE("pair spectra: segments that touch a missing sample of either are dropped and said") {
  auto x = normals(2000, 4), y = normals(2000, 5);
  x[300] = std::nan("");
  y[1500] = std::nan("");
  const CrossSpectrum cross = cross_spectrum(x, y, 1, segments_of_128());
  CHECK(cross.dropped == 4);
  CHECK(cross.segments + cross.dropped == 30);
  REQUIRE(cross.notes.size() == 1);
  CHECK(cross.notes[0].find("4 of 30 segments") == 0);
  const Spectrogram gram = spectrogram(x, 1, segments_of_128());
  CHECK(gram.value[3].empty());
  CHECK(gram.value[4].empty());
  CHECK(gram.value[5].size() == 65);
  CHECK(median_welch(x, 1, segments_of_128()).dropped == 2);
}

TEST_CASE("median average: its expected value is taken out, bursts do not count, degrees of freedom") {
  CHECK(expected_median(1) == 1);
  CHECK(expected_median(2) == 1);
  CHECK(expected_median(3) == Approx(5.0 / 6).epsilon(1e-15));
  CHECK(expected_median(100001) == Approx(std::log(2.0)).epsilon(1e-5));
  double sum = 0, squares = 0, bins = 0;
  WelchOptions options = segments_of_128();
  options.overlap = 0;
  Spectrum median;
  for (unsigned seed = 0; seed < 60; ++seed) {
    median = median_welch(normals(128 * 31, 300 + seed), 1, options);
    for (std::size_t k = 3; k + 3 < median.value.size(); ++k) {
      sum += median.value[k];
      squares += median.value[k] * median.value[k];
      ++bins;
    }
  }
  const double mean = sum / bins, variance = squares / bins - mean * mean;
  CHECK(mean == Approx(2).epsilon(0.02));  // white noise of variance 1 at 1 Hz, one-sided
  CHECK(2 * mean * mean / variance == Approx(median.dof[10]).epsilon(0.08));
  auto burst = normals(128 * 31, 7);
  const Spectrum before = median_welch(burst, 1, options);
  for (std::size_t i = 1000; i < 1100; ++i) burst[i] *= 1000;
  const Spectrum after = median_welch(burst, 1, options), by_mean = welch(burst, 1, options);
  CHECK(after.value[20] < 1.5 * before.value[20]);
  CHECK(by_mean.value[20] > 100 * before.value[20]);
}

TEST_CASE("spectrogram: its mean is Welch's spectrum, in every scaling") {
  const auto x = normals(1500, 8);
  for (const Scaling scaling : {Scaling::psd, Scaling::ps})
    for (const Sides sides : {Sides::one, Sides::two}) {
      WelchOptions options = segments_of_128();
      options.scaling = scaling;
      options.sides = sides;
      const Spectrogram gram = spectrogram(x, 20, options);
      const Spectrum mean = welch(x, 20, options);
      for (std::size_t k = 0; k < gram.frequency_hz.size(); ++k) {
        double sum = 0;
        for (const auto& row : gram.value) sum += row[k];
        const std::size_t at = mean.value.size() - gram.frequency_hz.size() + k;
        CHECK(sum / double(gram.value.size()) == Approx(mean.value[at]).epsilon(1e-10).margin(1e-13));
      }
    }
}

TEST_CASE("pair spectra: what is not possible is refused in a sentence") {
  const auto x = normals(300, 9);
  const WelchOptions options = segments_of_128();
  CHECK(test::code_of([&] { cross_spectrum(x, normals(299, 1), 1, options); }) == "E0873");
  WelchOptions whole;
  whole.segment = 300;
  CHECK(test::code_of([&] { cross_spectrum(x, x, 1, whole); }) == "E0874");
  CHECK(test::code_of([&] { cross_spectrum(x, x, 0, options); }) == "E0402");
  WelchOptions longer;
  longer.segment = 301;
  const Spectrogram quarters = spectrogram(x, 1, {});  // as Welch's spectrum has them
  CHECK(quarters.segment == x.size() / 4);
  CHECK(quarters.value.size() == 6);  // of 75, whose halves are 38
  CHECK(test::code_of([&] { spectrogram(std::span(x).first(5), 1, {}); }) == "E0875");
  CHECK(test::code_of([&] { spectrogram(x, 1, longer); }) == "E0875");
  WelchOptions crowded;
  crowded.segment = 20000;
  crowded.overlap = 0.9999;
  CHECK(test::code_of([&] { median_welch(normals(200000, 1), 1, crowded); }) == "E0872");
}
