// What is taken for an effect of temperature, and what becomes of one: false alarms, the
// coefficient and its interval, the random walk afterwards. Usage: temperature_bench [records = 40]
#include <fmt/format.h>

#include <cstdlib>
#include <memory>

#include "libchar/fit/noise_fit.hpp"
#include "tests/support/weather.hpp"

namespace {

using namespace libchar;
using test::Weather;

constexpr double kRate = 10, kWhite = 5e-3;
constexpr std::size_t kSamples = 40'000;

struct Kind {
  Weather weather;
  const char* name;
};
constexpr Kind kKinds[] = {{Weather::drifting, "drifting"},
                           {Weather::daily, "daily"},
                           {Weather::warming, "warming"},
                           {Weather::ramp, "ramp"},
                           {Weather::cycling, "cycling"}};
struct Noise {
  double flicker, walk;
};
constexpr Noise kUnmoved[] = {{0, 0}, {5e-3, 0}, {5e-3, 1.5e-4}, {0, 1e-3}};

void print_false_alarms(int records) {
  int found = 0, of = 0;
  for (const Kind& kind : kKinds)
    for (const Noise& noise : kUnmoved) {
      test::NoiseSource source(kSamples, kRate, 901 + static_cast<unsigned>(kind.weather));
      for (int i = 0; i < records; ++i, ++of) {
        const std::vector<double> y = source.record(kWhite, noise.flicker, noise.walk);
        const auto t = test::weather(kind.weather, kSamples, source.gauss());
        found += find_temperature_effect(y, kRate, t).order > 0 ? 1 : 0;
      }
    }
  fmt::print("not moved by it: {} of {} found\n", found, of);
}

void print_effect(const Kind& kind, double lag_s, int records) {
  constexpr double kPerK = 0.01, kWalk = 5e-4;
  test::NoiseSource source(kSamples, kRate, 951 + static_cast<unsigned>(kind.weather));
  int found = 0, covered = 0;
  double sum = 0, clean = 0, with = 0, left_in = 0;
  for (int i = 0; i < records; ++i) {
    std::vector<double> y = source.record(kWhite, 0, kWalk);
    FitOptions options;
    options.second_opinion = false;
    const double before = fit_record(y, kRate, nullptr, options).theta[2];
    const auto t = test::weather(kind.weather, kSamples, source.gauss());
    test::add_effect(y, t, kRate, lag_s, kPerK);
    const double untreated = fit_record(y, kRate, nullptr, options).theta[2];
    const NoiseFit fit = fit_record(y, kRate, nullptr, options, nullptr, {&t, nullptr, {}});
    if (!fit.temperature || fit.temperature->order == 0) continue;
    ++found;
    const Interval& ci = fit.temperature->ci95;
    covered += ci.low <= kPerK && kPerK <= ci.high ? 1 : 0;
    sum += fit.temperature->coefficient[0];
    clean += before;
    with += fit.theta[2];
    left_in += untreated;
  }
  fmt::print(
      "{:9} lag {:2} s: found {:3} of {}, interval holds {:3}, mean {:.4f}, K² {:.2f} × the clean fit's, left in "
      "{:.2f}\n",
      kind.name, lag_s, found, records, covered, sum / found, with / clean, left_in / clean);
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 40;
  print_false_alarms(records);
  for (const Kind& kind : kKinds)
    for (const double lag_s : {0.0, 60.0}) print_effect(kind, lag_s, records);
}
