// Simulated noise in other units: the same numbers times a power of two.
#include <cmath>

#include "libchar/benchmark/detail/estimators.hpp"
#include "libchar/benchmark/detail/stress_cells.hpp"

namespace libchar {
namespace {

constexpr double kSimulatedDigits = 13, kSimulatedDenormalDigits = 12;

struct Kind {
  const char* name;
  void (*set)(double level, SensorModel&);
};

void set_term(Term term, double level, SensorModel& model) {
  Coefficient& c = model.noise[static_cast<std::size_t>(term)];
  c.status = Status::detected;
  c.value = level;
}

constexpr Kind kKinds[] = {
    {"simulated white noise", [](double level, SensorModel& m) { set_term(Term::white, level, m); }},
    {"simulated flicker", [](double level, SensorModel& m) { set_term(Term::flicker, level, m); }},
    {"simulated random walk", [](double level, SensorModel& m) { set_term(Term::walk, level, m); }},
    {"simulated quantization noise", [](double level, SensorModel& m) { set_term(Term::quantization, level, m); }},
    {"simulated Gauss-Markov process",
     [](double level, SensorModel& m) { m.gauss_markov.sigma = level, m.gauss_markov.tau_s = 2; }}};

std::vector<double> simulated(const Kind& kind, int power, std::uint64_t seed) {
  BenchSignal signal;
  signal.rate_hz = 100;
  signal.samples = 4001;
  kind.set(std::ldexp(1.0, power), signal.model);
  return record_of(signal, seed);
}

}  // namespace

std::vector<StressCell> stress_simulators(const StressBenchOptions& options) {
  struct Scale {
    const char* name;
    int power;
  };
  std::vector<StressCell> out;
  for (const Scale& scale : {Scale{"scale 10⁹⁰", 300}, Scale{"scale 10⁻⁹⁰", -300}, Scale{"scale 10²⁰⁰", 664},
                             Scale{"scale 10⁻²⁰⁰", -664}, Scale{"denormal (10⁻³¹⁰)", -1030}})
    for (const Kind& kind : kKinds)
      out.push_back(stress_cell(kind.name, scale.name, [&](StressCell& cell) {
        std::vector<Exact> expected;
        for (const double y : simulated(kind, 0, options.seed))
          expected.push_back(static_cast<double>(std::ldexp(Exact(y), scale.power)));
        judge_digits(right_digits_together(simulated(kind, scale.power, options.seed), expected),
                     scale.power < -1000 ? kSimulatedDenormalDigits : kSimulatedDigits, cell);
      }));
  return out;
}

}  // namespace libchar
