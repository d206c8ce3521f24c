// How many sensors, how long a record: by closed forms, and the check by simulation agrees.

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/benchmark/bench_document.hpp"

using namespace libchar;

namespace {

BenchSignal sensor_of(const std::string& name, double white, double walk) {
  BenchSignal signal{name, {}, 100, 1000};
  const auto give = [&](Term term, double value) {
    Coefficient& c = signal.model.noise[static_cast<std::size_t>(term)];
    if (value <= 0) return;
    c.status = Status::given;
    c.value = value;
  };
  give(Term::white, white);
  give(Term::walk, walk);
  return signal;
}

}  // namespace

TEST_CASE("design: n white sensors, closed form and simulated") {
  DesignOptions options;
  options.target = 3.4e-3;
  options.tau_s = 0.5;
  options.records = 100;
  // sigma(0.5 s) = 5e-3 / sqrt(0.5) = 7.071e-3; (7.071/3.4)^2 = 4.33: five.
  const DesignBench bench = bench_design({sensor_of("a", 5e-3, 0)}, options);
  REQUIRE(bench.sensors.size() == 1);
  const SensorsNeeded& needed = bench.sensors[0];
  CHECK(needed.single == Approx(5e-3 / std::sqrt(0.5)));
  CHECK(needed.sensors == 5);
  CHECK(needed.predicted == Approx(needed.single / std::sqrt(5.0)));
  CHECK(needed.simulated.count == 100);
  CHECK(needed.simulated.value == Approx(needed.predicted).epsilon(0.08));
  CHECK_FALSE(bench.one_of_each);
}

TEST_CASE("design: different sensors together have the sum of their information") {
  DesignOptions options;
  options.target = 1;
  options.records = 2;
  const DesignBench bench = bench_design({sensor_of("a", 3e-3, 0), sensor_of("b", 4e-3, 0)}, options);
  CHECK(*bench.one_of_each == Approx(12e-3 / 5));
  CHECK(bench.sensors[0].sensors == 1);
}

TEST_CASE("design: record length of white noise is 1/(2 share^2), and the likelihood gets there") {
  DesignOptions options;
  options.share = 0.05;
  options.records = 60;
  const DesignBench bench = bench_design({sensor_of("a", 5e-3, 0)}, options);
  REQUIRE(bench.records.size() == 1);
  CHECK(bench.records[0].samples == Approx(200).epsilon(0.03));
  CHECK(bench.records[0].simulated.value == Approx(0.05).epsilon(0.3));
  CHECK(bench.sensors.empty());
}

TEST_CASE("design: what does not go together is refused") {
  DesignOptions options;
  options.target = 1e-3;
  options.tau_s = 1e-3;
  CHECK_THROWS_WITH(bench_design({sensor_of("a", 5e-3, 0)}, options), Catch::Contains("E0967"));
  options.tau_s = 1;
  BenchSignal other = sensor_of("b", 5e-3, 0);
  other.rate_hz = 50;
  CHECK_THROWS_WITH(bench_design({sensor_of("a", 5e-3, 0), other}, options), Catch::Contains("E0967"));
}
