// Faults against remedies: bias of Q, B, K in units of the Cramér-Rao bound, before and after the
// automatic remedies, and how often which remedy was called. Usage: fit_faults_bench [records = 60]
#include <fmt/format.h>

#include <cstdlib>
#include <functional>
#include <limits>
#include <map>
#include <string>

#include "libchar/fit/curve/bounds.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "tests/support/noise.hpp"

namespace {

using namespace libchar;

struct Scene {
  std::string name;
  double rate_hz, q, b, k;
};

constexpr std::size_t kSamples = 200000;
using Fault = std::function<void(std::vector<double>&, const Scene&, test::Gaussian&)>;

double white_sd(const Scene& scene) { return scene.q * std::sqrt(scene.rate_hz); }

void drift(std::vector<double>& y, const Scene& scene, test::Gaussian&) {
  // A ramp whose Allan deviation at T/4 is three times that of the noise.
  const double tau = static_cast<double>(y.size()) / scene.rate_hz / 4;
  const double noise = std::sqrt(scene.q * scene.q / tau + 0.4413 * scene.b * scene.b + scene.k * scene.k * tau / 3);
  const double slope = 3 * noise * std::sqrt(2.0) / tau;
  for (std::size_t t = 0; t < y.size(); ++t) y[t] += slope * static_cast<double>(t) / scene.rate_hz;
}

const std::vector<std::pair<std::string, Fault>> kFaults = {
    {"clean", [](std::vector<double>&, const Scene&, test::Gaussian&) {}},
    {"spikes .1 % 20 sd",
     [](std::vector<double>& y, const Scene& scene, test::Gaussian& gauss) {
       for (std::size_t i = 0; i < y.size() / 1000; ++i) {
         y[static_cast<std::size_t>(gauss.uniform() * static_cast<double>(y.size()))] +=
             (gauss.uniform() < 0.5 ? 20 : -20) * white_sd(scene);
       }
     }},
    {"1 % missing, isolated",
     [](std::vector<double>& y, const Scene&, test::Gaussian& gauss) {
       for (double& value : y) {
         if (gauss.uniform() < 0.01) value = std::numeric_limits<double>::quiet_NaN();
       }
     }},
    {"1 % missing, 10 bursts",
     [](std::vector<double>& y, const Scene&, test::Gaussian& gauss) {
       for (int i = 0; i < 10; ++i) {
         const auto from = static_cast<std::size_t>(gauss.uniform() * 0.99 * static_cast<double>(y.size()));
         for (std::size_t t = from; t < from + y.size() / 1000; ++t) y[t] = std::numeric_limits<double>::quiet_NaN();
       }
     }},
    {"sine .5 sd at fs/4",
     [](std::vector<double>& y, const Scene& scene, test::Gaussian&) {
       for (std::size_t t = 0; t < y.size(); ++t)
         y[t] += 0.5 * white_sd(scene) * std::sin(2 * M_PI * 0.250123 * static_cast<double>(t));
     }},
    {"drift 3 x ADEV(T/4)", drift},
    {"warm-up exp T/5",
     [](std::vector<double>& y, const Scene& scene, test::Gaussian& gauss) {
       std::vector<double> ramp(y.size(), 0.0);
       drift(ramp, scene, gauss);
       for (std::size_t t = 0; t < y.size(); ++t)
         y[t] += ramp.back() * std::exp(-5 * static_cast<double>(t) / static_cast<double>(y.size()));
     }},
    {"all four",
     [](std::vector<double>& y, const Scene& scene, test::Gaussian& gauss) {
       for (const std::size_t i : {1U, 2U, 4U, 5U}) kFaults[i].second(y, scene, gauss);
     }},
};

void run(const Scene& scene, const std::string& name, const Fault& fault, int records) {
  test::NoiseSource source(kSamples, scene.rate_hz, 99);
  test::Gaussian faults(3);
  const std::array<double, 3> truth = {scene.q, scene.b, scene.k};
  const auto bound = cramer_rao({scene.q * scene.q, scene.b * scene.b, scene.k * scene.k, 0, 0}, scene.rate_hz,
                                kSamples, {true, true, true, false, false});
  std::array<std::array<double, 3>, 2> sum{}, square{};
  std::map<std::string, int> remedies;
  FitOptions options;
  options.second_opinion = false;
  options.threshold = 0.0;  // bias without the decision's own
  for (int r = 0; r < records; ++r) {
    std::vector<double> y = source.record(scene.q, scene.b, scene.k);
    fault(y, scene, faults);
    for (const bool remedy : {false, true}) {
      options.remedies = remedy;
      const NoiseFit fit = fit_record(y, scene.rate_hz, nullptr, options);
      for (std::size_t i = 0; i < 3; ++i) {
        const double error = (fit.term[i].value.value_or(0) - truth[i]) / (*bound[i] * truth[i]);
        sum[remedy][i] += error / records;
        square[remedy][i] += error * error / records;
      }
      for (const Remedy& done : fit.remedies) ++remedies[done.kind];
    }
  }
  fmt::print("{:3} {:24}", scene.name, name);
  for (const std::size_t with : {0U, 1U}) {
    for (std::size_t i = 0; i < 3; ++i) fmt::print(" {:7.2f}", sum[with][i]);
    fmt::print("  |");
    for (std::size_t i = 0; i < 3; ++i) fmt::print(" {:6.2f}", std::sqrt(square[with][i]));
    fmt::print("  ||");
  }
  for (const auto& [kind, count] : remedies) fmt::print(" {} {:.0f}%", kind, 100.0 * count / records);
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 60;
  fmt::print(
      "bias and rms error of Q, B, K in Cramér-Rao bounds; left without, right with remedies; how often each remedy\n");
  for (const Scene& scene : {Scene{"f", 200, 1e-3, 1e-2, 5e-3}, Scene{"b'", 20.0 / 3, 1e-3, 1.598e-4, 4.137e-6}}) {
    for (const auto& [name, fault] : kFaults)
      if (argc < 3 || name.rfind(argv[2], 0) == 0) run(scene, name, fault, records);
  }
}
