// By oneTBB.
#include <malloc.h>
#include <sys/resource.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/parallel/thread_limit.hpp"
#include "libchar/core/process/sanitizer.hpp"
#if LIBCHAR_SANITIZED_THREADS
#include <sanitizer/tsan_interface.h>
#endif

namespace libchar {
namespace parallel {
namespace {

// A task sees all that happened before it was given out, and the thread that waits for it sees all that the task did.
// oneTBB guarantees both, but is not compiled with the thread sanitizer: these calls tell it.
#if LIBCHAR_SANITIZED_THREADS
void give(void* at) { __tsan_release(at); }
void take(void* at) { __tsan_acquire(at); }
#else
void give(void*) {}
void take(void*) {}
#endif

/// Whether this thread works inside `isolated`, as the tasks do that are given out there.
thread_local bool is_isolated = false;

class Inside {
 public:
  explicit Inside(bool isolated) : before_(is_isolated) { is_isolated = isolated; }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
  ~Inside() { is_isolated = before_; }

 private:
  bool before_;
};

/// Exists from giving tasks out until all of them have ended.
class Handover {
 public:
  Handover() { give(&begun_); }
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;
  ~Handover() { take(&ended_); }

  void piece(Call<void()> work) {
    struct Ended {
      char& at;
      ~Ended() { give(&at); }
    } const ended{ended_};
    take(&begun_);
    const Inside inside(isolated_);
    work();
  }

 private:
  const bool isolated_ = is_isolated;
  char begun_ = 0, ended_ = 0;
};

/// Exists while a stage has an item: it sees what the stage before did to the item, and its own previous call.
class InStage {
 public:
  InStage(char* stage, void* item) : stage_(stage), item_(item) {
    take(stage_);
    take(item_);
  }
  InStage(const InStage&) = delete;
  InStage& operator=(const InStage&) = delete;
  ~InStage() {
    give(item_);
    give(stage_);
  }

 private:
  char* stage_;
  void* item_;
};

}  // namespace

bool has_threads() { return true; }

void over_ranges(std::size_t first, std::size_t last, std::size_t grain, Call<void(std::size_t, std::size_t)> work) {
  if (first >= last) return;
  Handover out;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(first, last, grain),
                    [&](const auto& range) { out.piece([&] { work(range.begin(), range.end()); }); });
}

void both(Call<void()> one, Call<void()> other) {
  Handover out;
  tbb::parallel_invoke([&] { out.piece(one); }, [&] { out.piece(other); });
}

void isolated(Call<void()> work) {
  tbb::this_task_arena::isolate([&] {
    const Inside inside(true);
    work();
  });
}

void in_order(std::size_t most, const Stages& stages) {
  using tbb::filter_mode;
  Handover out;
  char reads = 0, firsts = 0, lasts = 0;
  const auto pass = [&out](Call<void(void*)> stage, char* at) {
    return [&out, stage, at](void* item) {
      out.piece([&] {
        const InStage in(at == nullptr ? static_cast<char*>(item) : at, item);
        stage(item);
      });
      return item;
    };
  };
  const auto last = pass(stages.last, &lasts);
  tbb::parallel_pipeline(
      most, tbb::make_filter<void, void*>(filter_mode::serial_in_order,
                                          [&](tbb::flow_control& flow) {
                                            void* item = nullptr;
                                            out.piece([&] {
                                              take(&reads);
                                              item = stages.read();
                                              give(&reads);
                                            });
                                            if (item == nullptr)
                                              flow.stop();
                                            else
                                              give(item);
                                            return item;
                                          }) &
                tbb::make_filter<void*, void*>(filter_mode::serial_in_order, pass(stages.first, &firsts)) &
                tbb::make_filter<void*, void*>(filter_mode::parallel, pass(stages.work, nullptr)) &
                tbb::make_filter<void*, void>(filter_mode::serial_in_order, [&](void* item) { last(item); }));
}

// An arena only for fewer threads than there are. TBB keeps one whose workers are busy elsewhere and looks at all that
// it has kept whenever work is given out: with one for each curve of 4,000 channels half of the time went there.
struct Threads::State {
  std::optional<tbb::task_arena> arena;
};

Threads::Threads(int threads) : state_(detail::hidden<State>()) { limit_to(threads); }

void Threads::limit_to(int threads) {
  if (threads > 0 && threads < processors_given()) state_->arena.emplace(threads);
}

void Threads::run(Call<void()> work) {
  // A region within a region would shut out who waits in the outer one: it would help with nothing, and turn in circles
  // as long as there is something (a curve of 1,740 times: one thread's work, twice its processor time).
  if (!state_->arena) return is_isolated ? work() : isolated(work);
  Handover out;
  state_->arena->execute([&] { out.piece(work); });
}

struct OneThread::State {
  tbb::global_control control{tbb::global_control::max_allowed_parallelism, 1};
};

OneThread::OneThread() : state_(detail::hidden<State>()) {}

}  // namespace parallel

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
int processors_given() { return std::max(1, tbb::info::default_concurrency()); }

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
  controls->push_back(std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                            static_cast<std::size_t>(std::max(1, threads))));
}

}  // namespace libchar
