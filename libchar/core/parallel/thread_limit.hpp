#pragma once
// How many threads the system gives, and no more than that.

namespace libchar {

/// Processors that this process may run on: those of the machine, or as many as `taskset` or a batch system leaves it.
int processors_given();

/// Tries how many more threads can be made, as many as there are processors. Where there are fewer, everything in this
/// process that works in parallel keeps to them from now on: the pool of threads underneath (oneTBB) would otherwise
/// throw in the middle of work. Under a limit of address space (ulimit -v) the threads are started at once, while there
/// is room for their stacks, and share one heap. For programs, at their start.
void keep_to_threads_given();

/// Everything in this process that works in parallel keeps to `threads` (at least one) from now on: a job among others
/// on its machine. Results never depend on it.
void keep_to_threads(int threads);

}  // namespace libchar
