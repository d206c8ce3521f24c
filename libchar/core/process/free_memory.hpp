#pragma once
// Memory that the program has freed and the allocator keeps.

namespace libchar {

namespace detail {
/// Blocks of a few megabytes that come and go all the time are kept instead of given back to the system: they need no
/// new pages. For programs, at their start.
void keep_freed_blocks();
}  // namespace detail

/// Gives back what is kept, where the allocator is glibc's: before a step that takes much memory of its own. It costs
/// the first touch of as many pages later.
void give_back_free_memory();

}  // namespace libchar
