#pragma once
// Where the system gives this process few threads or little memory: what TBB does not ask, and ends the process for.

#include <tbb/global_control.h>

#include <memory>

namespace sensorchar {

/// Tries to have as many threads at once as there are cores. Where that is refused, nothing is done in parallel while the result
/// lives; nullptr otherwise. Under a limit of address space (ulimit -v) the threads of TBB are started at once, while there is room
/// for their stacks, and share one heap.
std::unique_ptr<tbb::global_control> keep_to_allowed_threads();

}  // namespace sensorchar
