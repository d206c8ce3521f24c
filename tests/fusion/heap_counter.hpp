#pragma once
// Counts trips to the heap, whoever makes them (Eigen, operator new, C). 0 under sanitizers, which
// bring a heap of their own.

#include <cstddef>

// gcc says it by a macro, clang by a feature.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TEST_HEAP_IS_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) && !defined(TEST_HEAP_IS_SANITIZED)
#define TEST_HEAP_IS_SANITIZED
#endif

namespace test {

std::size_t heap_trips();
inline constexpr bool kHeapCounted =
#if defined(TEST_HEAP_IS_SANITIZED)
    false;
#else
    true;
#endif

}  // namespace test
