#pragma once
// Counts trips to the heap, whoever makes them (Eigen, operator new, C). 0 under sanitizers, which
// bring a heap of their own.

#include <cstddef>

#include "libchar/core/process/sanitizer.hpp"

namespace test {

std::size_t heap_trips();
inline constexpr bool kHeapCounted = LIBCHAR_SANITIZED_HEAP == 0;

}  // namespace test
