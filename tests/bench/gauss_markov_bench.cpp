// A first-order Gauss-Markov process against flicker and walk: found, its coefficients and their intervals; and how
// often flicker and walk are taken for one. Usage: gauss_markov_bench [records = 200]
#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "libchar/fit/noise_fit.hpp"
#include "tests/support/gauss_markov.hpp"

namespace {

using namespace libchar;

bool in_model(const NoiseFit& fit) { return fit.gauss_markov && fit.gauss_markov->in_model; }

bool holds(const Coefficient& c, double truth) { return c.ci95.low <= truth && truth <= c.ci95.high; }

void print_process(std::size_t samples, double rate_hz, int records) {
  constexpr double kWhite = 5e-3, kSigma = 0.02, kTau = 60;
  int found = 0, either = 0, sigma = 0, tau = 0;
  double mean_sigma = 0, mean_tau = 0;
  for (int r = 0; r < records; ++r) {
    const auto seed = static_cast<std::uint64_t>(77 + r);
    const std::vector<double> y = test::white_and_process(seed, samples, rate_hz, kWhite, kSigma, kTau);
    const NoiseFit fit = fit_record(y, rate_hz, nullptr);
    either += !in_model(fit) && fit.gauss_markov ? 1 : 0;
    if (!in_model(fit)) continue;
    ++found;
    sigma += holds(fit.gauss_markov->sigma, kSigma) ? 1 : 0;
    tau += holds(fit.gauss_markov->tau_s, kTau) ? 1 : 0;
    mean_sigma += *fit.gauss_markov->sigma.value / kSigma;
    mean_tau += *fit.gauss_markov->tau_s.value / kTau;
  }
  fmt::print(
      "{:.0f} correlation times: found {} of {}, looked for and left {}; sigma x {:.3f}, tau x {:.3f}; intervals hold "
      "{} and {}\n",
      static_cast<double>(samples) / rate_hz / kTau, found, records, either, mean_sigma / found, mean_tau / found,
      sigma, tau);
}

void print_false_alarms(int records) {
  struct Terms {
    double flicker, walk;
  };
  for (const Terms& terms : {Terms{5e-3, 1.5e-3}, Terms{5e-3, 0}, Terms{0, 1.5e-3}, Terms{1e-3, 3e-4}}) {
    constexpr std::size_t kSamples = 60'000;
    test::NoiseSource source(kSamples, 100, 31);
    int found = 0;
    for (int r = 0; r < records; ++r)
      found += in_model(fit_record(source.record(5e-3, terms.flicker, terms.walk), 100, nullptr));
    fmt::print("B {} K {}: taken for one in {} of {}\n", terms.flicker, terms.walk, found, records);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 200;
  print_process(120'000, 10, records);
  print_process(120'000, 100, records);
  print_false_alarms(records);
}
