#pragma once
// A piece of work with a result, in a thread next to the caller.

#include <future>
#include <system_error>

#include "libchar/core/parallel/parallel.hpp"

namespace libchar::parallel {

/// Begins in a thread next to the caller; where no thread is to be had, when its result is asked for.
template <class Work>
auto beside(const Work& work) {
  if (has_threads()) {
    try {
      return std::async(std::launch::async, work);
    } catch (const std::system_error&) {
      // Afterwards, then.
    }
  }
  return std::async(std::launch::deferred, work);
}

}  // namespace libchar::parallel
