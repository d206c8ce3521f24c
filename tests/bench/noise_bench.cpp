// Simulated noise: run time, memory, and error.
//   build/tests/bench/noise_bench [samples]             speed against other ways, user CPU, best of
//                                                       several interleaved runs
//   build/tests/bench/noise_bench --memory SAMPLES      streams so many samples, prints the peak
//   RSS build/tests/bench/noise_bench --error               error of the flicker filter by length
//   build/tests/bench/noise_bench --spectrum RECORDS    spectrum of simulated flicker by decade
//   build/tests/bench/noise_bench --allan RECORDS       Allan curve of flicker, 2^25 samples a
//   record
// tests/bench/noise_bench.py adds the same record made with numpy and scipy.

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"
#include "libchar/simulate/detail/noise_generator.hpp"
#include "libchar/spectrum/fft.hpp"
#include "tests/support/flicker.hpp"
#include "tests/support/kasdin.hpp"
#include "tests/support/kernels.hpp"

using namespace libchar;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kBlock = 4096;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

double peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

NoiseDesign tactical_gyro(std::array<bool, 3> terms = {true, true, true}) {
  NoiseDesign design;
  design.rate_hz = 200;
  design.coefficient = {terms[0] ? 5e-3 : 0, terms[1] ? 1e-3 : 0, terms[2] ? 1e-4 : 0, 0, 0};
  return design;
}

/// Streams n samples through one block; the sum keeps the work alive.
double stream(const NoiseDesign& design, std::size_t n) {
  NoiseGenerator generator(design, 1, 0);
  std::vector<double> block(kBlock);
  double sum = 0;
  for (std::size_t t = 0; t < n; t += kBlock) {
    std::fill(block.begin(), block.end(), 0.0);
    generator.add(block, {});
    sum += block.back();
  }
  return sum;
}

std::vector<double> normals(std::size_t n, Purpose purpose) {
  std::vector<double> out(n);
  DeviateStream({1, 0, purpose}).fill_normal(out);
  return out;
}

/// Adds white noise and walk to flicker held in memory, as the whole-record ways do.
double finish_record(std::vector<double>& y) {
  const std::vector<double> white = normals(y.size(), Purpose::white), walk = normals(y.size(), Purpose::walk);
  double level = 0;
  for (std::size_t t = 0; t < y.size(); ++t) {
    level += 7e-6 * walk[t];
    y[t] = 1e-3 * y[t] + 0.07 * white[t] + level;
  }
  return y.back();
}

/// The usual recipe: white spectrum times f^-1/2, inverse transform. Wraps around: the record's end
/// joins its beginning, and nothing lies below 1/T.
double by_spectrum(std::size_t n) {
  RealFft fft(n);
  const std::vector<double> drawn = normals(n + 2, Purpose::flicker);
  const auto c = fft.coefficients();
  c[0] = 0;
  for (std::size_t k = 1; k <= n / 2; ++k)
    c[k] = std::complex<double>(drawn[2 * k], drawn[2 * k + 1]) *
           std::sqrt(0.25 / std::sin(kPi * static_cast<double>(k) / static_cast<double>(n)));
  const auto x = fft.inverse();
  std::vector<double> y(x.begin(), x.end());
  const double scale = 1 / std::sqrt(static_cast<double>(n));
  for (double& value : y) value *= scale;
  return finish_record(y);
}

double by_convolution(std::size_t n) {
  std::vector<double> y = test::kasdin_filter(normals(n, Purpose::flicker));
  return finish_record(y);
}

struct Way {
  std::string name;
  std::function<double()> work;
  std::size_t samples;
  double best = 1e300;  ///< ns a sample
};

void speed(std::size_t n) {
  double sink = 0;
  const NoiseDesign all = tactical_gyro();
  NoiseDesign cut = all, known = all;
  cut.flicker_method = "rv-truncated-iir";
  known.length = n;
  std::vector<double> block(kBlock);
  DeviateStream deviates({1, 0, Purpose::truth});
  FlickerStream filter(design_flicker(0));
  std::vector<double> driving(kBlock);
  deviates.fill_normal(driving);
  const auto blocks = [n](const std::function<void()>& work) {
    for (std::size_t t = 0; t < n; t += kBlock) work();
  };
  std::vector<Way> ways;
  ways.push_back({"flicker + white + walk, streamed", [&] { return stream(all, n); }, n});
  ways.push_back({"same, length stated", [&] { return stream(known, n); }, n});
  ways.push_back({"  of it: one normal deviate",
                  [&] {
                    blocks([&] { deviates.fill_normal(block); });
                    return block[0];
                  },
                  n});
  ways.push_back({"  of it: the flicker filter",
                  [&] {
                    blocks([&] {
                      block = driving;
                      filter.run(block);
                    });
                    return block[0];
                  },
                  n});
  ways.push_back({"  white alone", [&] { return stream(tactical_gyro({true, false, false}), n); }, n});
  ways.push_back({"  walk alone", [&] { return stream(tactical_gyro({false, false, true}), n); }, n});
  ways.push_back({"(a) shaped spectrum, one inverse FFT", [&] { return by_spectrum(n); }, n});
  ways.push_back({"(a) exact convolution by FFT, padded", [&] { return by_convolution(n); }, n});
  ways.push_back({"(b) recursive filter of 1000 taps", [&] { return stream(cut, n / 8); }, n / 8});
  for (int round = 0; round < 5; ++round)
    for (Way& way : ways) {
      const double start = cpu_seconds();
      sink += way.work();
      way.best = std::min(way.best, (cpu_seconds() - start) / static_cast<double>(way.samples) * 1e9);
    }
  fmt::print("{} samples, one thread, user CPU, best of 5 interleaved (sink {:.3g})\n", n, sink);
  for (const Way& way : ways)
    fmt::print("{:>8.2f} ns/sample {:>8.1f} M/s   x {:>6.2f}   {}\n", way.best, 1e3 / way.best, way.best / ways[0].best,
               way.name);
}

void error() {
  fmt::print("{:>16} {:>9} {:>12} {:>12} {:>12}   largest relative error\n", "length", "sections", "response", "power",
             "variogram");
  for (const std::uint64_t length :
       {std::uint64_t{1000}, std::uint64_t{1'000'000}, std::uint64_t{1'000'000'000}, std::uint64_t{0}}) {
    const FlickerFilter filter = design_flicker(length);
    const double n = static_cast<double>(length == 0 ? kLongestFlicker : length);
    double response = 0, power = 0, variogram = 0;
    for (int i = 0; i <= 4000; ++i) {
      const double k = std::round(std::pow(n, i / 4000.0)), z = 1 / k;
      const double exact = k < 100 ? test::kasdin_series(1, static_cast<std::size_t>(k) + 1).back()
                                   : (1 - z / 8 + z * z / 128 + 5 * z * z * z / 1024) / std::sqrt(kPi * k);
      response = std::max(response, std::fabs(test::flicker_response(filter, k) / exact - 1));
      variogram = std::max(variogram, std::fabs(test::flicker_variogram(filter, k) / (4 / kPi * odd_harmonic(k)) - 1));
      const double nu = 0.5 * std::pow(n, -i / 4000.0);
      power = std::max(power, std::fabs(test::flicker_power(filter, nu) * 2 * std::sin(kPi * nu) - 1));
    }
    fmt::print("{:>16} {:>9} {:>12.2e} {:>12.2e} {:>12.2e}\n", static_cast<std::uint64_t>(n), filter.loss.size(),
               response, power, variogram);
  }
}

/// Records of 2^22 samples; the fast decades from the first 2^16, the slow ones from means of 1024,
/// each against its exact expectation.
void spectrum(std::size_t records) {
  constexpr std::size_t kSamples = std::size_t{1} << 22U, kHead = std::size_t{1} << 16U, kMean = 1024,
                        kMeans = kSamples / kMean;
  Dct head(kHead), slow(kMeans);
  const BlockMeanDct slow_model(kMeans, kMean, 1);
  std::array<double, 8> sum{}, lines{};
  const auto collect = [&](std::span<const double> c, double length, const auto& in_range, const auto& mean) {
    for (std::size_t k = 1; k < c.size(); ++k) {
      const double nu = static_cast<double>(k) / (2 * length);
      if (!in_range(nu)) continue;
      const auto decade = static_cast<std::size_t>(std::floor(-std::log10(2 * nu)));
      if (decade >= sum.size()) continue;
      sum[decade] += c[k] * c[k] / mean(k);
      ++lines[decade];
    }
  };
  std::vector<double> head_mean(kHead), slow_mean(kMeans);
  for (std::size_t k = 1; k < kHead; ++k) head_mean[k] = dct_mean(static_cast<double>(k), kHead, 1)[1];
  for (std::size_t k = 1; k < kMeans; ++k) slow_mean[k] = slow_model.mean(k)[1];
  NoiseDesign design;
  design.coefficient = {0, 1, 0, 0, 0};
  std::vector<double> block(kHead), first, means(kMeans);
  for (std::size_t r = 0; r < records; ++r) {
    NoiseGenerator generator(design, 1, r);
    for (std::size_t t = 0; t < kSamples; t += kHead) {
      std::fill(block.begin(), block.end(), 0.0);
      generator.add(block, {});
      if (t == 0) first = block;
      for (std::size_t b = 0; b < kHead / kMean; ++b) {
        double total = 0;
        for (std::size_t i = 0; i < kMean; ++i) total += block[b * kMean + i];
        means[t / kMean + b] = total / std::sqrt(double(kMean));
      }
    }
    collect(
        head.transform(first), kHead, [](double nu) { return nu >= 0.5e-3; },
        [&](std::size_t k) { return head_mean[k]; });
    collect(
        slow.transform(means), kSamples, [](double nu) { return nu < 0.5e-3; },
        [&](std::size_t k) { return slow_mean[k]; });
  }
  fmt::print("{} records of {} samples of flicker\n", records, kSamples);
  for (std::size_t d = 0; d < sum.size() && lines[d] > 0; ++d)
    fmt::print("nu {:.1e} .. {:.1e}: power/exact {:.5f} +- {:.5f} ({:+.2f} sd)\n", 0.5 * std::pow(10, -double(d) - 1),
               0.5 * std::pow(10, -double(d)), sum[d] / lines[d], std::sqrt(2 / lines[d]),
               (sum[d] / lines[d] - 1) / std::sqrt(2 / lines[d]));
}

/// Mean Allan variances of long records of flicker against the exact curve, with the exact edf.
void allan(std::size_t records) {
  constexpr std::size_t kSamples = std::size_t{1} << 25U;
  NoiseDesign design;
  design.coefficient = {0, 1, 0, 0, 0};
  const Mixture theta = {0, 1, 0, 0, 0};
  std::vector<double> block(kBlock), sum;
  AllanCurve curve;
  for (std::size_t r = 0; r < records; ++r) {
    NoiseGenerator generator(design, 2, r);
    AllanPyramid pyramid;
    for (std::size_t t = 0; t < kSamples; t += kBlock) {
      std::fill(block.begin(), block.end(), 0.0);
      generator.add(block, {});
      pyramid.push(block);
    }
    curve = pyramid.finish(1);
    sum.resize(curve.points.size(), 0.0);
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += curve.points[j].deviation * curve.points[j].deviation;
  }
  fmt::print("{} records of {} samples of flicker\n", records, kSamples);
  for (std::size_t j = 0; j < sum.size(); ++j) {
    const AllanPoint& point = curve.points[j];
    const double m = static_cast<double>(point.m), count = static_cast<double>(records);
    const double ratio = sum[j] / count / unit_allan_variance(Term::flicker, m, 1);
    const double edf = count * equivalent_dof(curve.type, theta, point.m, point.terms, stride_of(curve, point), 1);
    fmt::print("m {:>9}: variance/exact {:.5f} +- {:.5f} ({:+.2f} sd), p {:.3f}\n", point.m, ratio, std::sqrt(2 / edf),
               (ratio - 1) / std::sqrt(2 / edf),
               2 * std::min(chi_square_cdf(ratio * edf, edf), chi_square_tail(ratio * edf, edf)));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view mode = argc > 1 ? argv[1] : "";
  const auto number = [&](std::size_t otherwise) { return argc > 2 ? std::strtoull(argv[2], nullptr, 10) : otherwise; };
  if (mode == "--memory") {
    const std::size_t n = number(1'000'000);
    const double start = cpu_seconds(), sum = stream(tactical_gyro(), n);
    fmt::print("{} samples: peak RSS {:.1f} MiB, {:.2f} ns/sample user CPU (sink {:.3g})\n", n, peak_mib(),
               (cpu_seconds() - start) / static_cast<double>(n) * 1e9, sum);
  } else if (mode == "--error") {
    error();
  } else if (mode == "--allan") {
    allan(number(32));
  } else if (mode == "--spectrum") {
    spectrum(number(200));
  } else {
    speed(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1U << 23U);
    test::print_kernels("noise");
  }
}
