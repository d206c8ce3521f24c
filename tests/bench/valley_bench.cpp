// Departures from the noise model that are too weak for the alarm of the fit, or just strong enough: how often the 95 %
// interval holds N, how far N is off, how often the channel is called good, and how often it is called good while an
// interval of N, B or K excludes the truth (silent). Usage: valley_bench [records = 24] [kind = ""]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/fit/curve/bounds.hpp"
#include "tests/support/noise.hpp"

namespace {

using namespace libchar;
using Samples = std::vector<double>;

constexpr double kRate = 100, kN = 5e-3, kB = 5e-3, kK = 1.5e-3;
constexpr std::size_t kLead = 20000;  ///< samples in which a filter settles

struct Scene {
  double n = kN, b = kB, k = kK;
  std::array<double, 3> truth() const { return {n, b, k}; }
  double sd() const { return n * std::sqrt(kRate); }
};

using Departure = std::function<void(Samples&, const Scene&, test::Gaussian&)>;
struct Kind {
  std::string name;
  std::size_t samples = 200000;
  Departure depart;
  Scene scene = {};
};

/// y = b0 x + b1 x_-1 + b2 x_-2 - a1 y_-1 - a2 y_-2.
struct Biquad {
  double b0 = 1, b1 = 0, b2 = 0, a1 = 0, a2 = 0;
};

Departure filter(const Biquad& f) {
  return [f](Samples& y, const Scene&, test::Gaussian&) {
    double x1 = 0, x2 = 0, y1 = 0, y2 = 0;
    for (double& value : y) {
      const double x = value;
      value = f.b0 * x + f.b1 * x1 + f.b2 * x2 - f.a1 * y1 - f.a2 * y2;
      x2 = x1;
      x1 = x;
      y2 = y1;
      y1 = value;
    }
  };
}

Departure one_pole(double corner_over_rate) {
  const double a = std::exp(-2 * std::numbers::pi * corner_over_rate);
  return filter({1 - a, 0, 0, -a, 0});
}
Departure tap(double e) { return filter({1 / (1 + e), e / (1 + e), 0, 0, 0}); }
/// Second order by the bilinear transform, unit gain at rest.
Departure second_order(double corner_hz, double damping) {
  const double w = std::tan(std::numbers::pi * corner_hz / kRate), w2 = w * w;
  const double norm = 1 / (1 + 2 * damping * w + w2);
  return filter({w2 * norm, 2 * w2 * norm, w2 * norm, 2 * (w2 - 1) * norm, (1 - 2 * damping * w + w2) * norm});
}
/// First order, gain 1 at rest and `gain` far above the corner.
Departure shelf(double corner_hz, double gain) {
  const double w = std::tan(std::numbers::pi * corner_hz / kRate), norm = 1 / (1 + w);
  return filter({(gain + w) * norm, (w - gain) * norm, 0, (w - 1) * norm, 0});
}
/// Of gain 1 at half the rate.
Departure high_pass(double corner_hz) {
  const double a = std::exp(-2 * std::numbers::pi * corner_hz / kRate);
  return filter({(1 + a) / 2, -(1 + a) / 2, 0, -a, 0});
}
Departure alpha_beta(double alpha, double beta) {
  return [=](Samples& y, const Scene&, test::Gaussian&) {
    double x = y.front(), v = 0;
    for (double& value : y) {
      const double predicted = x + v, innovation = value - predicted;
      x = predicted + alpha * innovation;
      v += beta * innovation;
      value = x;
    }
  };
}
Departure quantization(double qz) {
  return [=](Samples& y, const Scene&, test::Gaussian& gauss) {
    double before = gauss();
    for (double& value : y) {
      const double now = gauss();
      value += qz * kRate * (now - before);
      before = now;
    }
  };
}
Departure spikes(double sigmas, double share, bool one_sided = false) {
  return [=](Samples& y, const Scene& scene, test::Gaussian& gauss) {
    for (double& value : y)
      if (gauss.uniform() < share) value += sigmas * scene.sd() * (one_sided || gauss.uniform() < 0.5 ? 1 : -1);
  };
}
/// 1/f^exponent as a sum of first-order processes, four a decade; crosses white noise near 1 Hz.
Departure power_law(double exponent) {
  return [=](Samples& y, const Scene& scene, test::Gaussian& gauss) {
    std::vector<double> state, pole, drive;
    for (double f = 3e-5; f < kRate / 2; f *= std::pow(10, 0.25)) {
      const double a = std::exp(-2 * std::numbers::pi * f / kRate);
      const double variance = scene.n * scene.n * f * std::pow(f, -exponent) * 1.8;
      pole.push_back(a);
      drive.push_back(std::sqrt(variance * (1 - a * a)));
      state.push_back(std::sqrt(variance) * gauss());
    }
    for (double& value : y)
      for (std::size_t i = 0; i < state.size(); ++i) value += state[i] = pole[i] * state[i] + drive[i] * gauss();
  };
}
Departure telegraphs(double sigmas) {
  return [=](Samples& y, const Scene& scene, test::Gaussian& gauss) {
    for (const double rate_hz : {0.003, 0.02, 0.1, 0.6, 4.0}) {
      double level = gauss() > 0 ? 0.5 : -0.5;
      for (double& value : y) {
        if (gauss.uniform() < rate_hz / kRate) level = -level;
        value += sigmas * scene.sd() * level;
      }
    }
  };
}
Departure triangle(double period_s, double sigmas) {
  return [=](Samples& y, const Scene& scene, test::Gaussian& gauss) {
    const double start = gauss.uniform();
    for (std::size_t t = 0; t < y.size(); ++t) {
      const double phase = std::fmod(static_cast<double>(t) / kRate / period_s + start, 1.0);
      y[t] += sigmas * scene.sd() * (4 * std::abs(phase - 0.5) - 1);
    }
  };
}
Departure footsteps(double sigmas) {
  return [=](Samples& y, const Scene& scene, test::Gaussian& gauss) {
    double next = 50;
    for (std::size_t t = 0; t < y.size(); ++t)
      if (static_cast<double>(t) >= next) {
        for (std::size_t i = 0; i < 40 && t + i < y.size(); ++i)
          y[t + i] +=
              sigmas * scene.sd() * std::exp(-0.1 * static_cast<double>(i)) * std::sin(0.9 * static_cast<double>(i));
        next += 55 + 8 * gauss();
      }
  };
}
Departure zeros(double share) {
  return [=](Samples& y, const Scene&, test::Gaussian& gauss) {
    for (double& value : y)
      if (gauss.uniform() < share) value = 0;
  };
}
Departure dead_band(double sigmas) {
  return [=](Samples& y, const Scene& scene, test::Gaussian&) {
    for (double& value : y)
      if (std::abs(value) < sigmas * scene.sd()) value = 0;
  };
}
Departure gauss_markov(std::vector<std::pair<double, double>> sd_tau) {
  return [=](Samples& y, const Scene& scene, test::Gaussian& gauss) {
    for (const auto& [sigmas, tau_s] : sd_tau) {
      const double a = std::exp(-1 / (kRate * tau_s)), sd = sigmas * scene.sd();
      double state = sd * gauss();
      for (double& value : y) value += state = a * state + sd * std::sqrt(1 - a * a) * gauss();
    }
  };
}
void nothing(Samples&, const Scene&, test::Gaussian&) {}

std::vector<Kind> kinds() {
  constexpr std::size_t kLong = 200000, kShort = 4000;
  const Scene white{kN, 0, 0}, flicker{kN, kB, 0}, walk{kN, 0, kK};
  std::vector<Kind> out;
  for (const std::size_t n : {kLong, kShort})
    for (const auto& [scene, name] :
         {std::pair{Scene{}, "N B K"}, std::pair{white, "N"}, std::pair{flicker, "N B"}, std::pair{walk, "N K"}})
      out.push_back({fmt::format("clean {} {}", name, n), n, nothing, scene});
  for (const double f : {1.2, 0.8, 0.65, 0.5}) out.push_back({fmt::format("pole {} {}", f, kLong), kLong, one_pole(f)});
  for (const double f : {1.0, 0.65, 0.5, 0.4, 0.3})
    out.push_back({fmt::format("pole {} {}", f, kShort), kShort, one_pole(f)});
  for (const double q : {1e-5, 4e-5, 6e-5, 1e-4})
    out.push_back({fmt::format("quantization {} {}", q, kLong), kLong, quantization(q)});
  for (const double q : {2e-5, 1e-4, 1.5e-4, 2.5e-4})
    out.push_back({fmt::format("quantization {} {}", q, kShort), kShort, quantization(q)});
  for (const double e : {0.003, 0.01, 0.02, 0.1}) out.push_back({fmt::format("tap {}", e), kLong, tap(e)});
  for (const double share : {0.003, 0.006, 0.012})
    out.push_back({fmt::format("spikes 6 sd {}", share), kLong, spikes(6, share)});
  out.push_back({"spikes 4 sd 0.003", kLong, spikes(4, 0.003)});
  out.push_back({"spikes 8 sd 0.003 one-sided", kLong, spikes(8, 0.003, true)});
  out.push_back({"spikes 12 sd 0.003", kLong, spikes(12, 0.003)});
  for (const double f : {2.0, 0.5}) out.push_back({fmt::format("shelf 1.3 at {} Hz", f), kLong, shelf(f, 1.3)});
  out.push_back({"shelf 0.8 at 2 Hz", kLong, shelf(2, 0.8)});
  for (const double f : {1.0, 2.0, 3.0, 5.0, 20.0})
    out.push_back({fmt::format("butterworth 2 at {} Hz", f), kLong, second_order(f, 0.7071)});
  out.push_back({"closed loop 0.7 at 1 Hz", kLong, second_order(1, 0.7)});
  out.push_back({"resonance 0.4 at 2 Hz", kLong, second_order(2, 0.4)});
  out.push_back({"alpha-beta .1 .005", kLong, alpha_beta(0.1, 0.005)});
  for (const double a : {0.8, 1.3, 1.6}) out.push_back({fmt::format("1/f^{}", a), kLong, power_law(a), white});
  out.push_back({"high-pass 0.01 Hz", kLong, high_pass(0.01)});
  out.push_back({"high-pass 0.1 Hz", kLong, high_pass(0.1)});
  out.push_back({"telegraphs of five rates", kLong, telegraphs(0.2)});
  out.push_back({"footsteps", kLong, footsteps(0.5)});
  out.push_back({"triangle 150 s", kLong, triangle(150, 0.5)});
  out.push_back({"zeros 2 %", kLong, zeros(0.02), white});
  out.push_back({"dead band 0.5 sd", kLong, dead_band(0.5), white});
  out.push_back({"pole 0.003", kLong, one_pole(0.003), white});
  out.push_back({"Gauss-Markov 0.2 s", kLong, gauss_markov({{1, 0.2}}), white});
  out.push_back({"Gauss-Markov 0.1 s and 5 s", kLong, gauss_markov({{1, 0.1}, {1, 5}}), white});
  out.push_back({"Gauss-Markov 0.5 s and 5 s", kLong, gauss_markov({{1, 0.5}, {1, 5}}), white});
  out.push_back({"Gauss-Markov 0.03 s and 3 s", kLong, gauss_markov({{1, 0.03}, {1, 3}}), white});
  out.push_back({"Gauss-Markov 1 s and 10 s", kLong, gauss_markov({{1, 1}, {1, 10}}), white});
  out.push_back({"Gauss-Markov 0.5 s and 20 s", kLong, gauss_markov({{1, 0.5}, {1, 20}}), white});
  return out;
}

Recording recording_of(Samples samples) {
  Recording recording;
  recording.info.time.rate_hz = kRate;
  recording.info.channels.push_back({"x", "", false});
  recording.samples.push_back(std::move(samples));
  return recording;
}

bool holds(const Coefficient& term, double truth) {
  if (!term.value) return !term.upper95 || !(truth > *term.upper95 * (1 + 1e-12)) || truth == 0;
  return term.ci95.low <= truth && truth <= term.ci95.high;
}

void run(const Kind& kind, int records) {
  test::NoiseSource source(kind.samples + kLead, kRate, 11);
  test::Gaussian gauss(7);
  const std::array<double, 3> truth = kind.scene.truth();
  const auto bound = cramer_rao({truth[0] * truth[0], truth[1] * truth[1], truth[2] * truth[2], 0, 0}, kRate,
                                static_cast<double>(kind.samples), {true, truth[1] > 0, truth[2] > 0, false, false});
  std::array<int, 3> held{}, valued{};
  int good = 0, silent = 0;
  double error = 0, square = 0, width = 0;
  std::map<std::string, int> said;
  CharacterizeOptions options;
  for (int r = 0; r < records; ++r) {
    Samples y = source.record(kind.scene.n, kind.scene.b, kind.scene.k);
    kind.depart(y, kind.scene, gauss);
    y.erase(y.begin(), y.begin() + kLead);
    const ChannelResult result = characterize(recording_of(std::move(y)), options).channels[0];
    if (!result.fit) continue;
    const NoiseFit& fit = *result.fit;
    const Judgement judged = judge(result);
    bool right = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool holds_it = holds(fit.term[i], truth[i]);
      held[i] += holds_it ? 1 : 0;
      valued[i] += fit.term[i].value && fit.term[i].status == Status::detected ? 1 : 0;
      right = right && holds_it;
    }
    if (std::getenv("SHOW") != nullptr) {
      fmt::print("  N {:.3f} B {:.3f} K {:.3f} (over truth) p {:.3f}, band to {:.3g} Hz",
                 fit.term[0].value.value_or(0) / truth[0], fit.term[1].value.value_or(0) / truth[1],
                 fit.term[2].value.value_or(0) / truth[2], fit.goodness.p, fit.band.top_hz);
      for (const Remedy& remedy : fit.remedies) fmt::print("; {}", remedy.action);
      fmt::print("\n");
    }
    good += judged.rating == Rating::good ? 1 : 0;
    silent += judged.rating == Rating::good && !right ? 1 : 0;
    for (const Finding& finding : judged.findings) ++said[finding.code];
    const Coefficient& white = fit.term[0];
    const double z = white.value ? (*white.value / truth[0] - 1) / *bound[0] : 0;
    error += z / records;
    square += z * z / records;
    width += white.relative_sd / *bound[0] / records;
  }
  fmt::print(
      "{:30} N {:4.2f} B {:4.2f} K {:4.2f} | det {:3} {:3} {:3} | off {:7.2f} rms {:7.2f} stated {:6.2f} | good {:3} "
      "silent {:3} |",
      kind.name, static_cast<double>(held[0]) / records, static_cast<double>(held[1]) / records,
      static_cast<double>(held[2]) / records, valued[0], valued[1], valued[2], error, std::sqrt(square), width, good,
      silent);
  for (const auto& [code, count] : said) fmt::print(" {}:{}", code, count);
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 24;
  const std::string wanted = argc > 2 ? argv[2] : "";
  for (const Kind& kind : kinds())
    if (kind.name.rfind(wanted, 0) == 0) run(kind, records);
}
