#pragma once
// Memory that the program has freed and the allocator keeps.

namespace libchar {

/// Gives it back to the system, where the allocator is glibc's: before a step that takes much memory of its own. It costs the first
/// touch of as many pages later.
void give_back_free_memory();

}  // namespace libchar
