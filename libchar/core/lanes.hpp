#pragma once
// Explicit vector lanes: the order of additions is spelled out, so that every vector width gives
// the same bits.

namespace libchar {

using Four = double __attribute__((vector_size(32)));
using FourInMemory = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Four doubles from or to any address. A macro, because a function that returns a vector changes
/// its ABI with the target clone.
#define LIBCHAR_FOUR(pointer) (*reinterpret_cast<const ::libchar::FourInMemory*>(pointer))
#define LIBCHAR_FOUR_TO(pointer) (*reinterpret_cast<::libchar::FourInMemory*>(pointer))

// Clang and the address sanitizer do without: they cannot resolve clones at start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define LIBCHAR_WIDE_LANES __attribute__((target_clones("avx2", "default")))
#else
#define LIBCHAR_WIDE_LANES
#endif

}  // namespace libchar
