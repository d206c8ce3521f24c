#include "libchar/core/process/free_memory.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace libchar {

void detail::keep_freed_blocks() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_THRESHOLD, 256 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 512 << 20);
#endif
}

void give_back_free_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

}  // namespace libchar
