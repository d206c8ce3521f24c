#pragma once
// The one place that knows which instructions a processor has. Those that only some have are used
// on x86-64, where it has them; nowhere when the build says LIBCHAR_PORTABLE (an option of CMake),
// which tests the code that every other processor runs.

#include <atomic>

#if defined(__x86_64__) && !defined(LIBCHAR_PORTABLE)
#define LIBCHAR_X86_64
/// A function that runs only where `instructions()` says so.
#define LIBCHAR_AVX2 target("avx2,bmi,bmi2,popcnt")
#elif defined(__wasm_simd128__) && !defined(LIBCHAR_PORTABLE)
/// A web page: every browser that opens it has vectors of 16 bytes.
#define LIBCHAR_WASM
#endif

namespace libchar::detail {

/// What kernels are compiled for; each has the instructions of those before it.
enum class Instructions { any, avx2 };
inline constexpr Instructions kAllInstructions[] = {Instructions::any, Instructions::avx2};

/// The most that this processor has.
Instructions instructions_there();

/// Those that kernels use: all that are there.
inline std::atomic<Instructions> g_instructions{instructions_there()};
inline Instructions instructions() { return g_instructions.load(std::memory_order_relaxed); }

/// While one lives, kernels use no more than these: for tests and benches. Results never depend on it.
class UseInstructions {
 public:
  explicit UseInstructions(Instructions most) : before_(g_instructions.exchange(most)) {}
  ~UseInstructions() { g_instructions = before_; }
  UseInstructions(const UseInstructions&) = delete;
  UseInstructions& operator=(const UseInstructions&) = delete;

 private:
  Instructions before_;
};

}  // namespace libchar::detail
