#pragma once
// Simulated records of a signal.

#include <vector>

#include "libchar/benchmark/characterization_bench.hpp"

namespace libchar {

/// theta of what a simulation of the model uses.
Mixture truth_of(const SensorModel& model);

/// One sensor, its noise alone.
std::vector<double> record_of(const BenchSignal& signal, std::uint64_t seed);

/// The mean of so many independent ones.
std::vector<double> mean_of_records(const BenchSignal& signal,
                                    std::uint64_t sensors,
                                    std::uint64_t seed);

}  // namespace libchar
