#pragma once
// Explicit vector lanes: the order of additions is spelled out, so that every vector width gives
// the same bits. The compiler splits a vector where the registers are narrower.

#include "libchar/core/process/processor.hpp"

namespace libchar {

using Four = double __attribute__((vector_size(32)));
// The attributes precede the "=": clang ignores `aligned` after it.
using FourInMemory [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
static_assert(alignof(FourInMemory) == 8);

/// Four doubles from or to any address. A macro, because a function that returns a vector changes
/// its ABI with the instructions.
#define LIBCHAR_FOUR(pointer) (*reinterpret_cast<const ::libchar::FourInMemory*>(pointer))
#define LIBCHAR_FOUR_TO(pointer) (*reinterpret_cast<::libchar::FourInMemory*>(pointer))

/// A kernel: inlined into a function for each kind of instructions; `InLanes` calls the one that this
/// processor runs. A kernel is neither a member nor a template, and calls nothing that stays a call.
#define LIBCHAR_LANES [[gnu::always_inline]] static inline

}  // namespace libchar

namespace libchar::detail {

template <auto kKernel>
struct InLanes;

template <class Result, class... Arguments, Result (*kKernel)(Arguments...)>
struct InLanes<kKernel> {
  Result operator()(Arguments... arguments) const {
#if defined(LIBCHAR_X86_64)
    if (instructions() >= Instructions::avx2) return with_avx2(arguments...);
#endif
    return with_any(arguments...);
  }

 private:
  [[gnu::noinline]] static Result with_any(Arguments... arguments) { return kKernel(arguments...); }
#if defined(LIBCHAR_X86_64)
  __attribute__((LIBCHAR_AVX2, noinline)) static Result with_avx2(Arguments... arguments) {
    return kKernel(arguments...);
  }
#endif
};

}  // namespace libchar::detail

namespace libchar {
using namespace detail;
}
