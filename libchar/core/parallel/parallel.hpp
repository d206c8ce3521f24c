#pragma once
// What runs side by side. This room is the only place that knows how: by oneTBB (threads.cpp), or one after the other
// on a platform without threads (serial.cpp: LIBCHAR_SERIAL, a web page). Results never depend on it.
//
//   parallel::for_each(0, n, [&](std::size_t i) { … });       each index once, in any order
//   parallel::in_order(most, read, {work}, take);              a stream: read and take in order, work side by side

#include <cstddef>
#include <memory>
#include <type_traits>

#include "libchar/core/hidden.hpp"

namespace libchar::parallel {

/// A function that is called where it is given and not kept.
template <class Signature>
class Call;
template <class Result, class... Arguments>
class Call<Result(Arguments...)> {
 public:
  template <class Function>
  requires(!std::is_same_v<std::remove_cvref_t<Function>, Call>)
      Call(Function&& function)  // NOLINT(google-explicit-constructor): lambdas are given as they are
      : object_(const_cast<void*>(static_cast<const void*>(std::addressof(function)))),
        call_([](void* object, Arguments... arguments) -> Result {
          return (*static_cast<std::remove_reference_t<Function>*>(object))(arguments...);
        }) {}
  Result operator()(Arguments... arguments) const { return call_(object_, arguments...); }

 private:
  void* object_;
  Result (*call_)(void*, Arguments...);
};

/// Can a thread be started at all?
bool has_threads();

/// Ranges [begin, end) of [first, last), at least `grain` long where there are as many.
void over_ranges(std::size_t first, std::size_t last, std::size_t grain, Call<void(std::size_t, std::size_t)> work);

/// Every index of [first, last).
template <class Work>
void for_each(std::size_t first, std::size_t last, const Work& work) {
  over_ranges(first, last, 1, [&work](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

/// Both, and no more than that is begun by who waits for the other.
void both(Call<void()> one, Call<void()> other);

/// While it waits inside, this thread begins nothing from outside.
void isolated(Call<void()> work);

/// Items from `read` until it gives none, at most `most` of them under way. `read`, `first` and `last` see them one at
/// a time and in order, each on any thread; `work` sees several at once.
struct Stages {
  Call<void*()> read;
  Call<void(void*)> first, work, last;
};
void in_order(std::size_t most, const Stages& stages);

/// Where work that is given to it runs: on that many threads, or (0) as many as there are.
class Threads {
 public:
  explicit Threads(int threads = 0);
  /// Before the first `run`; 0: all.
  void limit_to(int threads);
  void run(Call<void()> work);

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// While one lives, everything keeps to one thread.
class OneThread {
 public:
  OneThread();

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar::parallel
