// Intervals of an RMSE (libchar/replay/error_meter.hpp): of 200 records of each kind, how many have
// one, how many of these hold the expected RMSE (of 600 other records), and how wide they are.
//   score_bench [RECORDS]

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <vector>

#include "libchar/replay/error_meter.hpp"
#include "libchar/simulate/detail/noise_generator.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

constexpr std::size_t kSamples = 32768;
constexpr std::uint64_t kOthers = 100000;  // seeds of the records that tell the truth

using Errors = std::function<std::vector<double>(std::uint64_t)>;

Errors of_terms(const Mixture& coefficients) {
  return [coefficients](std::uint64_t seed) {
    NoiseDesign design;
    design.coefficient = coefficients;
    design.rate_hz = 1;
    std::vector<double> e(kSamples, 0.0);
    NoiseGenerator(design, seed, 0).add(e, {});
    return e;
  };
}

Errors correlated_over(double samples) {
  return [samples](std::uint64_t seed) {
    test::Gaussian gauss(seed);
    const double memory = std::exp(-1 / samples);
    std::vector<double> e(kSamples);
    double state = gauss();
    for (double& value : e) {
      value = state;
      state = memory * state + std::sqrt(1 - memory * memory) * gauss();
    }
    return e;
  };
}

void row(const char* name, const Errors& errors, std::uint64_t records) {
  double squares = 0;
  for (std::uint64_t seed = kOthers; seed < kOthers + 600; ++seed)
    for (const double e : errors(seed)) squares += e * e / (600.0 * kSamples);
  const double truth = std::sqrt(squares);
  std::uint64_t stated = 0, covered = 0;
  std::vector<double> widths;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    ErrorMeter meter;
    meter.push(errors(seed));
    const ErrorScore s = score(meter, 1);
    if (!s.stationary) continue;
    ++stated;
    covered += s.rmse_ci95.low <= truth && truth <= s.rmse_ci95.high;
    widths.push_back(s.rmse_ci95.high / s.rmse_ci95.low - 1);
  }
  std::sort(widths.begin(), widths.end());
  fmt::print("{:<28} {:>8} {:>10} {:>12}\n", name, stated, covered,
             widths.empty() ? "-" : fmt::format("{:.1f} %", 100 * widths[widths.size() / 2]));
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t records = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 200;
  fmt::print("{:<28} {:>8} {:>10} {:>12}\n", "errors", "stated", "covering", "median width");
  row("white", correlated_over(0.05), records);
  row("correlated over 30 samples", correlated_over(30), records);
  row("correlated over 100", correlated_over(100), records);
  row("correlated over 1000", correlated_over(1000), records);
  row("flicker", of_terms({0, 1, 0, 0, 0}), records);
  row("white and flicker", of_terms({3, 1, 0, 0, 0}), records);
  row("white and walk", of_terms({30, 0, 0.1, 0, 0}), records);
  row("walk", of_terms({0, 0, 1, 0, 0}), records);
}
