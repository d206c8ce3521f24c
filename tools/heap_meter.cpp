// The C heap of this program with a counter in front of glibc's. Sizes are those of the blocks that
// glibc hands out, as they are when it takes them back.
#include "heap_meter.hpp"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstddef>

#include "libchar/core/process/sanitizer.hpp"

#if LIBCHAR_SANITIZED_HEAP == 0 && defined(__GLIBC__)

namespace {

thread_local std::int64_t held = 0, peak = 0;
std::atomic<bool> refused{false};

void* counted(void* block) {
  if (block != nullptr) {
    held += static_cast<std::int64_t>(malloc_usable_size(block));
    if (held > peak) peak = held;
  } else {
    refused.store(true, std::memory_order_relaxed);
  }
  return block;
}

void discount(void* block) {
  if (block != nullptr) held -= static_cast<std::int64_t>(malloc_usable_size(block));
}

}  // namespace

extern "C" {
void* __libc_malloc(std::size_t);
void __libc_free(void*);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) { return counted(__libc_malloc(size)); }
void free(void* block) {
  discount(block);
  __libc_free(block);
}
void* calloc(std::size_t count, std::size_t size) { return counted(__libc_calloc(count, size)); }
void* realloc(void* old, std::size_t size) {
  const auto before = old != nullptr ? static_cast<std::int64_t>(malloc_usable_size(old)) : 0;
  void* block = __libc_realloc(old, size);
  // Size 0 frees; a failure keeps the old block.
  if (block != nullptr || size == 0) held -= before;
  return size == 0 ? block : counted(block);
}
void* memalign(std::size_t alignment, std::size_t size) { return counted(__libc_memalign(alignment, size)); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return counted(__libc_memalign(alignment, size)); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = counted(__libc_memalign(alignment, size));
  return *block != nullptr ? 0 : ENOMEM;
}
}

namespace sensorchar {
namespace {

struct Meter final : libchar::HeapMeter {
  void begin() override {
    start_ = held;
    peak = held;
  }
  libchar::HeapUse end() override { return {held - start_, peak - start_}; }
  std::int64_t start_ = 0;
};

}  // namespace

libchar::HeapMeter* heap_meter() {
  static Meter meter;
  return &meter;
}

bool memory_was_refused() { return refused; }

}  // namespace sensorchar

#else

libchar::HeapMeter* sensorchar::heap_meter() { return nullptr; }

bool sensorchar::memory_was_refused() { return false; }

#endif
