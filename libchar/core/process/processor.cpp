#include "libchar/core/process/processor.hpp"

namespace libchar::detail {

Instructions instructions_there() {
#if defined(LIBCHAR_X86_64)
  __builtin_cpu_init();  // static objects may ask
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
      __builtin_cpu_supports("popcnt"))
    return Instructions::avx2;
#endif
  return Instructions::any;
}

}  // namespace libchar::detail
