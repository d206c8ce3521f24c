// The C heap of this program, with a counter in front of glibc's.

#include "tests/fusion/heap_counter.hpp"

#include <catch2/catch.hpp>
#include <memory>

#if LIBCHAR_SANITIZED_HEAP == 0

namespace {
thread_local std::size_t trips = 0;
}

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  ++trips;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++trips;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++trips;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++trips;
  return __libc_memalign(alignment, size);
}
}

std::size_t test::heap_trips() { return trips; }

#else

std::size_t test::heap_trips() { return 0; }

#endif

TEST_CASE("the heap counter counts") {
  const std::size_t before = test::heap_trips();
  const auto kept = std::make_unique<double[]>(100);
  CHECK((test::heap_trips() > before) == test::kHeapCounted);
  CHECK(kept[7] == 0);
}
