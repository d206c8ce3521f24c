#pragma once
// Counts the heap of this program, thread by thread: what an algorithm holds, whoever allocates it
// (operator new, Eigen's malloc, Ceres).

#include "libchar/core/process/work.hpp"

namespace sensorchar {

/// nullptr where the heap cannot be counted (under sanitizers, which bring their own).
libchar::HeapMeter* heap_meter();

/// Whether the system has refused memory so far; false where the heap cannot be counted.
bool memory_was_refused();

}  // namespace sensorchar
