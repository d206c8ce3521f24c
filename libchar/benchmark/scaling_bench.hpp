#pragma once
// How cost grows: with the length of a record, the number of sensors, true inputs, threads. Fitted
// exponents, and where a method stops keeping up with its sensors.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/benchmark/figure.hpp"
#include "libchar/core/process/heap_meter.hpp"
#include "libchar/core/process/progress.hpp"

namespace libchar {

struct ScalingBenchOptions {
  bool quick = false;
  std::uint64_t seed = 1;
  std::size_t rounds = 7;  ///< each point is timed so often, in turns
  double rate_hz = 1000;   ///< of the instants, for `keeps_up_to`
};

struct ScalingPoint {
  double x = 0;
  Figure cost;                  ///< in the unit of the series
  std::optional<double> bytes;  ///< of heap, at most
};

struct ScalingSeries {
  std::string name;
  std::string over;  ///< "samples", "sensors", "inputs", "threads"
  std::string unit;  ///< "ms", "ns per instant"
  std::vector<ScalingPoint> points;
  /// p of cost ~ x^p over the last three octaves; no count: too few points
  Figure exponent;
  /// of instants over sensors: the most sensors that one processor keeps up with at `rate_hz`,
  /// interpolated; extrapolated by the exponent, at most to a million
  std::optional<double> keeps_up_to;
};

struct ScalingBench {
  double rate_hz = 0;
  std::vector<ScalingSeries> series;
};

ScalingBench bench_scaling(const ScalingBenchOptions& options,
                           Progress& progress = no_progress(),
                           HeapMeter* heap = nullptr);

/// p of cost ~ x^p by least squares on the logarithms of the points whose x is at least an eighth
/// of the largest, with Student's interval.
Figure growth_exponent(const std::vector<ScalingPoint>& points);

}  // namespace libchar
