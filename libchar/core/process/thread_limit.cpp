#include "libchar/core/process/thread_limit.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace libchar {

namespace {

/// Threads that can be there at once beside this one, at most `most`.
std::size_t threads_given(std::size_t most) {
  std::mutex lock;
  std::condition_variable counted;
  bool done = false;
  std::vector<std::thread> threads;
  threads.reserve(most);
  try {
    while (threads.size() < most)
      threads.emplace_back([&] {
        std::unique_lock hold(lock);
        counted.wait(hold, [&] { return done; });
      });
  } catch (...) {
    // What there is will do.
  }
  {
    const std::lock_guard hold(lock);
    done = true;
  }
  counted.notify_all();
  for (std::thread& thread : threads) thread.join();
  return threads.size();
}

bool address_space_is_limited() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace

// The C++ library's own count is that of the machine.
int processors_given() {
  return std::max(1, tbb::info::default_concurrency());
}

void keep_to_threads_given() {
  const bool limited = address_space_is_limited();
  // A heap a thread takes 64 MB of addresses each, and where there are none left every allocation tries again.
  if (limited) ::mallopt(M_ARENA_MAX, 1);
  const auto wanted = static_cast<std::size_t>(processors_given() - 1);
  const std::size_t given = threads_given(wanted);
  if (given == wanted) {
    // At once, while there is room for their stacks.
    if (limited) tbb::parallel_for(std::size_t{0}, 4 * wanted, [](std::size_t) {});
    return;
  }
  keep_to_threads(static_cast<int>(given) + 1);
}

void keep_to_threads(int threads) {
  // For good: where one ends the pool wants its threads at once, in a destructor.
  using Controls = std::vector<std::unique_ptr<tbb::global_control>>;
  static Controls* const controls = new Controls;
  controls->push_back(
      std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(std::max(1, threads))));
}

}  // namespace libchar
