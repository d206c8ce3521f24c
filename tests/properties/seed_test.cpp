// Properties are tried on the same cases each time, unless the environment asks for others: a
// landing does not hang on luck.

#include <cstdlib>

namespace {

[[maybe_unused]] const int kSeeded = ::setenv("RC_PARAMS", "seed=20261124 max_success=200", 0);

}  // namespace
