#pragma once
// How much heap a piece of work holds. The library cannot know; a program that counts
// (tools/heap_meter.cpp) can say.

#include <cstdint>

namespace libchar {

struct HeapUse {
  std::int64_t held = 0;  ///< bytes allocated minus bytes freed since `begin`, on this thread
  std::int64_t peak = 0;  ///< largest value of `held` on the way
};

struct HeapMeter {
  virtual ~HeapMeter() = default;
  virtual void begin() = 0;
  virtual HeapUse end() = 0;
};

}  // namespace libchar
