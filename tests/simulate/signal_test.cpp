#include "libchar/simulate/signal.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/core/error.hpp"
#include "libchar/core/numeric/moments.hpp"

using namespace libchar;

namespace {

std::vector<double> run(const SignalSpec& spec, double rate, std::size_t n, std::size_t block = 1000) {
  const auto source = make_signal(spec, rate, n, 3, 0);
  std::vector<double> x(n);
  for (std::size_t at = 0; at < n; at += block) source->next(std::span(x).subspan(at, std::min(block, n - at)), {});
  return x;
}

SignalSpec of_kind(const std::string& kind) {
  SignalSpec spec;
  spec.kind = kind;
  return spec;
}

}  // namespace

TEST_CASE("signals: formulas") {
  SignalSpec sine = of_kind("sine");
  sine.amplitude = 2;
  sine.frequency_hz = 0.25;
  sine.offset = 1;
  CHECK(run(sine, 1, 6)[1] == Approx(3));
  CHECK(run(sine, 1, 6)[3] == Approx(-1));
  SignalSpec chirp = of_kind("chirp");
  chirp.from_hz = 1;
  chirp.to_hz = 3;
  const auto x = run(chirp, 1000, 2000);
  // 2 s from 1 to 3 Hz: t + t^2 / 2 turns
  CHECK(x[500] == Approx(std::sin(2 * std::numbers::pi * (0.5 + 0.125))).margin(1e-12));
  SignalSpec points = of_kind("points");
  points.points = {{1, 10}, {3, 20}};
  CHECK(run(points, 1, 5) == std::vector<double>{10, 10, 15, 20, 20});
  SignalSpec far = of_kind("sine");
  far.frequency_hz = 1;
  CHECK(run(far, 4, 40001, 4001)[40000] == Approx(0).margin(1e-12));
}

TEST_CASE("signals: noise has its deviation and its correlation") {
  SignalSpec noise = of_kind("noise");
  noise.standard_deviation = 3;
  noise.bandwidth_hz = 5;
  const auto x = run(noise, 100, 200000);
  Moments m;
  m.push(x);
  double lag = 0;
  for (std::size_t k = 1; k < x.size(); ++k) lag += x[k] * x[k - 1];
  CHECK(m.standard_deviation() == Approx(3).epsilon(0.03));
  CHECK(lag / static_cast<double>(x.size()) / 9 == Approx(std::exp(-2 * std::numbers::pi * 0.05)).epsilon(0.05));
}

TEST_CASE("signals: a held uniform changes at its renewals only") {
  SignalSpec uniform = of_kind("uniform");
  uniform.amplitude = 10;
  uniform.renew_s = 0.05;
  const auto x = run(uniform, 100, 20000);
  for (std::size_t k = 0; k + 5 <= x.size(); k += 5)
    for (std::size_t i = 1; i < 5; ++i) CHECK(x[k] == x[k + i]);
  CHECK(x[0] != x[5]);
  Moments m;
  m.push(x);
  CHECK(m.variance() == Approx(100.0 / 3).epsilon(0.05));
  CHECK(m.maximum() <= 10);
  uniform.renew_s = 0.003;  // several renewals between two samples: independent samples
  const auto fast = run(uniform, 100, 1000);
  for (std::size_t k = 1; k < fast.size(); ++k) CHECK(fast[k] != fast[k - 1]);
  uniform.renew_s = 0.01;
  uniform.repeat = 0.12;
  const auto kept = run(uniform, 100, 100000);
  std::size_t same = 0;
  for (std::size_t k = 1; k < kept.size(); ++k) same += kept[k] == kept[k - 1];
  CHECK(static_cast<double>(same) / 1e5 == Approx(0.12).epsilon(0.05));
}

TEST_CASE("signals: a walk spreads as its step says, and block sizes do not matter") {
  SignalSpec walk = of_kind("random_walk");
  walk.step = 2;
  Moments end;
  for (std::uint64_t index = 0; index < 2000; ++index) {
    std::vector<double> x(101);
    make_signal(walk, 25, 101, 1, index)->next(x, {});
    const double last = x.back();
    end.push({&last, 1});
  }
  CHECK(end.standard_deviation() == Approx(2 * std::sqrt(4.0)).epsilon(0.06));
  for (const std::string kind : {"noise", "uniform", "random_walk", "sine", "chirp"})
    CHECK(run(of_kind(kind), 100, 3000, 1) == run(of_kind(kind), 100, 3000, 999));
}

TEST_CASE("signals: the derivative sums up to its signal, sine_of and cosine_of follow it") {
  SignalSpec sine = of_kind("sine"), derivative = of_kind("derivative"), cosine = of_kind("cosine_of");
  cosine.amplitude = 9.81;
  const auto x = run(sine, 50, 200);
  std::vector<double> rate(200), c(200);
  const std::vector<std::span<const double>> earlier = {x};
  make_signal(derivative, 50, 200, 1, 1)->next(rate, earlier);
  make_signal(cosine, 50, 200, 1, 2)->next(c, earlier);
  double sum = x[0];
  for (std::size_t k = 1; k < 200; ++k) sum += rate[k] / 50;
  CHECK(sum == Approx(x[199]).margin(1e-12));
  CHECK(c[7] == Approx(9.81 * std::cos(x[7])));
}

TEST_CASE("signals: an unknown kind names the nearest") {
  CHECK_THROWS_WITH(make_signal(of_kind("sinus"), 1, 1, 1, 0), Catch::Contains("did you mean sine"));
  for (const std::string& kind : signal_kinds()) CHECK((kind == "zero" || !signal_keys(kind).empty()));
}
