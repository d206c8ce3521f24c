// One thing after the other: a platform without threads (LIBCHAR_SERIAL).
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/parallel/thread_limit.hpp"

namespace libchar {
namespace parallel {

bool has_threads() { return false; }

void over_ranges(std::size_t first, std::size_t last, std::size_t, Call<void(std::size_t, std::size_t)> work) {
  if (first < last) work(first, last);
}

void both(Call<void()> one, Call<void()> other) {
  one();
  other();
}

void isolated(Call<void()> work) { work(); }

void in_order(std::size_t, const Stages& stages) {
  while (void* const item = stages.read()) {
    stages.first(item);
    stages.work(item);
    stages.last(item);
  }
}

struct Threads::State {};

Threads::Threads(int) : state_(detail::hidden<State>()) {}

void Threads::limit_to(int) {}

void Threads::run(Call<void()> work) { work(); }

struct OneThread::State {};

OneThread::OneThread() : state_(detail::hidden<State>()) {}

}  // namespace parallel

int processors_given() { return 1; }

void keep_to_threads_given() {}

void keep_to_threads(int) {}

}  // namespace libchar
