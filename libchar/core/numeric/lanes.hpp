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
/// its ABI with the target clone.
#define LIBCHAR_FOUR(pointer) (*reinterpret_cast<const ::libchar::FourInMemory*>(pointer))
#define LIBCHAR_FOUR_TO(pointer) (*reinterpret_cast<::libchar::FourInMemory*>(pointer))

/// A function that is compiled twice, with and without AVX2; the loader picks one at start. Clang 14
/// knows no clones, and the address sanitizer is not ready when the loader asks.
#if defined(LIBCHAR_X86_64) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define LIBCHAR_WIDE_LANES __attribute__((target_clones("avx2", "default")))
#else
#define LIBCHAR_WIDE_LANES
#endif

}  // namespace libchar
