// Growth of cost: the exponent by hand, and what is measured is there.

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "libchar/benchmark/bench_document.hpp"

using namespace libchar;

namespace {

ScalingPoint cost_at(double x, double cost) { return {x, {cost, {cost, cost}, 7}, {}}; }

}  // namespace

TEST_CASE("exponent: of a power, over the last three octaves only") {
  // A cost that stands still at first, then grows as x^1.5.
  std::vector<ScalingPoint> points;
  for (const double x : {1.0, 2.0, 4.0}) points.push_back(cost_at(x, 7));
  for (const double x : {16.0, 32.0, 64.0, 128.0}) points.push_back(cost_at(x, std::pow(x, 1.5)));
  const Figure exponent = growth_exponent(points);
  CHECK(exponent.value == Approx(1.5).epsilon(1e-12));
  CHECK(exponent.ci95.high - exponent.ci95.low < 1e-9);
  CHECK(exponent.count == 4);
  CHECK(growth_exponent({cost_at(1, 1)}).count == 0);
  CHECK(std::isinf(growth_exponent({cost_at(1, 1), cost_at(2, 2)}).ci95.high));
}

TEST_CASE("growth is measured over samples, threads, sensors and inputs, and memory is not above reason") {
  ScalingBenchOptions options;
  options.quick = true;
  options.rounds = 1;
  const ScalingBench bench = bench_scaling(options);
  std::set<std::string> over;
  for (const ScalingSeries& series : bench.series) {
    over.insert(series.over);
    for (const ScalingPoint& point : series.points) CHECK(point.cost.value > 0);
  }
  CHECK(over == std::set<std::string>{"inputs", "samples", "sensors", "threads"});
}
