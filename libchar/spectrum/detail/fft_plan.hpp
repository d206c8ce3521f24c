#pragma once
// FFTW's plans and the memory that they run on.

#include <fftw3.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <type_traits>

namespace libchar::fft_plan {

struct Freed {
  void operator()(void* memory) const { fftw_free(memory); }
};
template <typename T>
using Aligned = std::unique_ptr<T[], Freed>;

/// Always fftw_malloc: the alignment of a buffer decides which code FFTW runs and so the last bits
/// of the result. Throws Error(numeric) where a transform is so long that it is the reason,
/// std::bad_alloc where there is no memory for a small one either.
void* allocated(std::size_t values, std::size_t bytes_each);

template <typename T>
Aligned<T> aligned(std::size_t n) {
  return Aligned<T>(static_cast<T*>(allocated(n, sizeof(T))));
}

/// FFTW's planner is the one part of it that must not run twice at once. Whoever holds it may
/// destroy a plan. Throws std::bad_alloc once memory has been refused within the planner: what it
/// holds then is not whole, and it is not asked again.
std::recursive_mutex& planner();

/// May run in several threads at once, each on memory of its own.
using Plan = std::shared_ptr<std::remove_pointer_t<fftw_plan>>;

/// Destroyed with its last owner. Throws std::bad_alloc where there is none.
Plan owned(fftw_plan plan);

/// The transforms that stand whole in memory from `aligned`, so that a plan of the length serves any of them.
enum class Kind { real_forward, real_backward, sums_of_cosines };

/// The plan of a length: the one made before where it is kept, else by `make`, under the planner's
/// mutex. Planning takes longer than a transform of some ten thousand values.
Plan planned(Kind kind, std::size_t n, const std::function<fftw_plan()>& make);

}  // namespace libchar::fft_plan
