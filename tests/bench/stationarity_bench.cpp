// How often a steady record is called unsteady, and what becomes of records that change. Usage:
// stationarity_bench [records = 200]
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "libchar/fit/noise_fit.hpp"
#include "tests/support/gauss_markov.hpp"
#include "tests/support/noise.hpp"

namespace {

using namespace libchar;
using Record = std::vector<double>;

struct Kind {
  std::string name;
  std::function<Record(unsigned)> make;
};

constexpr double kRate = 100;

Record terms(unsigned seed, std::size_t n, double white, double flicker, double walk) {
  test::NoiseSource source(n, kRate, seed);
  return source.record(white, flicker, walk);
}

/// Student's t of three degrees of freedom: kurtosis without bound.
Record heavy(unsigned seed, std::size_t n) {
  test::Gaussian normal(seed);
  Record y(n);
  for (double& x : y) {
    double chi2 = 0;
    for (int i = 0; i < 3; ++i) {
      const double z = normal();
      chi2 += z * z;
    }
    x = normal() / std::sqrt(chi2 / 3);
  }
  return y;
}

Record filtered(unsigned seed, std::size_t n) {
  Record y = terms(seed, n, 5e-3, 5e-3, 0);
  double state = 0;
  for (double& x : y) x = state += 0.3 * (x - state);
  return y;
}

Record rounded(Record y, double step) {
  for (double& x : y) x = std::round(x / step) * step;
  return y;
}

Record louder(Record y, double factor, double from, double to) {
  const auto n = static_cast<double>(y.size());
  for (std::size_t t = 0; t < y.size(); ++t) {
    const double x = static_cast<double>(t) / n;
    if (x >= from && x < to) y[t] *= factor;
  }
  return y;
}

std::vector<Kind> steady_kinds() {
  return {
      {"white, 20000", [](unsigned s) { return terms(s, 20'000, 5e-3, 0, 0); }},
      {"white, flicker, walk, 20000", [](unsigned s) { return terms(s, 20'000, 5e-3, 5e-3, 1.5e-3); }},
      {"white, flicker, walk, 200000", [](unsigned s) { return terms(s, 200'000, 5e-3, 5e-3, 1.5e-3); }},
      {"flicker, 50000", [](unsigned s) { return terms(s, 50'000, 1e-4, 5e-3, 0); }},
      {"walk, 50000", [](unsigned s) { return terms(s, 50'000, 1e-4, 0, 1.5e-3); }},
      {"Gauss-Markov, tau 5 s, 100000",
       [](unsigned s) { return test::white_and_process(s, 100'000, kRate, 5e-3, 0.02, 5); }},
      {"low-passed, 50000", [](unsigned s) { return filtered(s, 50'000); }},
      {"Student's t of 3, 50000", [](unsigned s) { return heavy(s, 50'000); }},
      {"steps of .7 sigma, 50000", [](unsigned s) { return rounded(terms(s, 50'000, 5e-3, 0, 0), 0.035); }},
  };
}

std::vector<Kind> changing_kinds() {
  const auto base = [](unsigned s) { return terms(s, 200'000, 5e-3, 5e-3, 0); };
  return {
      {"x 1.05 in a quarter", [=](unsigned s) { return louder(base(s), 1.05, 0.25, 0.5); }},
      {"x 1.02 in the second half", [=](unsigned s) { return louder(base(s), 1.02, 0.5, 1); }},
      {"x 1.5 in a sixteenth", [=](unsigned s) { return louder(base(s), 1.5, 0.5, 0.5625); }},
  };
}

void print(const Kind& kind, int records) {
  int tested = 0, unsteady = 0, noticeable = 0;
  for (int r = 0; r < records; ++r) {
    const NoiseFit fit = fit_record(kind.make(700 + static_cast<unsigned>(r)), kRate, nullptr);
    tested += fit.stationarity.tested ? 1 : 0;
    unsteady += fit.stationarity.steady ? 0 : 1;
    noticeable += fit.stationarity.noticeable ? 1 : 0;
  }
  fmt::print("{:32} tested {}, not the same throughout {}, by a twentieth and more {}\n", kind.name, tested, unsteady,
             noticeable);
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 200;
  fmt::print("steady, {} records each\n", records);
  for (const Kind& kind : steady_kinds()) print(kind, records);
  fmt::print("changing, {} records each\n", records / 4);
  for (const Kind& kind : changing_kinds()) print(kind, records / 4);
}
