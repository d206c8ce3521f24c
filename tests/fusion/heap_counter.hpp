#pragma once
// Counts trips to the heap, whoever makes them (Eigen, operator new, C). 0 under sanitizers, which
// bring a heap of their own.

#include <cstddef>

namespace test {

std::size_t heap_trips();
inline constexpr bool kHeapCounted =
#if defined(__SANITIZE_ADDRESS__)
    false;
#else
    true;
#endif

}  // namespace test
