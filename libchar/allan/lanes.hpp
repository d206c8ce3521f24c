#pragma once
// Four of the eight lanes in which the Allan kernels add; the compiler splits them where the
// registers are narrower.

namespace libchar {

using Four = double __attribute__((vector_size(32)));
using FourInMemory = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Four doubles from any address. A macro, because a function that returns a vector changes its ABI
/// with the target clone.
#define LIBCHAR_FOUR_AT(pointer) (*reinterpret_cast<const ::libchar::FourInMemory*>(pointer))
#define LIBCHAR_CLONES __attribute__((target_clones("avx2", "default")))

}  // namespace libchar
