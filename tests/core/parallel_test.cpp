// What runs side by side, by threads and (test_platform) one after the other: each piece once,
// streams in order, failures thrown.

#include "libchar/core/parallel/parallel.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "libchar/core/parallel/beside.hpp"
#include "libchar/core/parallel/thread_limit.hpp"

using namespace libchar;

TEST_CASE("parallel: each index once, in ranges that cover all") {
  for (const std::size_t count : {0U, 1U, 2U, 7U, 1000U}) {
    std::vector<std::atomic<int>> seen(count + 3);
    parallel::for_each(3, count + 3, [&](std::size_t i) { ++seen[i]; });
    for (std::size_t i = 0; i < seen.size(); ++i) CHECK(seen[i] == (i >= 3 ? 1 : 0));
    std::atomic<std::size_t> covered = 0;
    parallel::over_ranges(0, count, 10, [&](std::size_t begin, std::size_t end) { covered += end - begin; });
    CHECK(covered == count);
  }
}

TEST_CASE("parallel: both, isolated, in a pool of any size") {
  for (const int threads : {0, 1, 2, 100}) {
    std::atomic<int> done = 0;
    parallel::Threads(threads).run(
        [&] { parallel::isolated([&] { parallel::both([&] { done += 1; }, [&] { done += 10; }); }); });
    CHECK(done == 11);
  }
  const parallel::OneThread one;
  parallel::for_each(0, 100, [](std::size_t) {});
}

TEST_CASE("parallel: who waits in a region helps with what is run inside it") {
  using Clock = std::chrono::steady_clock;
  if (!parallel::has_threads() || processors_given() < 2) return;
  const auto until = [](const std::atomic<int>& count, int wanted) {
    const auto end = Clock::now() + std::chrono::seconds(10);
    while (count < wanted && Clock::now() < end) std::this_thread::yield();
    return count >= wanted;
  };
  const auto caller = std::this_thread::get_id();
  std::atomic<int> begun = 0, met = 0, there = 0;
  const auto half = [&] {
    // The caller leaves the work to the other thread, and waits.
    ++begun;
    if (!until(begun, 2) || std::this_thread::get_id() == caller) return;
    parallel::Threads(0).run([&] {
      parallel::for_each(0, 2, [&](std::size_t) {
        ++there;
        if (until(there, 2)) ++met;
      });
    });
  };
  parallel::isolated([&] { parallel::both(half, half); });
  if (begun == 2) CHECK(met == 2);
}

TEST_CASE("parallel: a stream is read and taken in order") {
  std::vector<int> items(50), read, first, taken;
  std::size_t next = 0;
  parallel::in_order(
      4,
      {.read = [&]() -> void* {
         if (next == items.size()) return nullptr;
         read.push_back(static_cast<int>(next));
         return &items[next++];
       },
       .first = [&](void* item) { first.push_back(static_cast<int>(static_cast<int*>(item) - items.data())); },
       .work = [&](void* item) { *static_cast<int*>(item) = static_cast<int>(static_cast<int*>(item) - items.data()); },
       .last = [&](void* item) { taken.push_back(*static_cast<int*>(item)); }});
  REQUIRE(taken.size() == items.size());
  CHECK(read == taken);
  CHECK(first == taken);
}

TEST_CASE("parallel: what work throws is thrown where it was asked for") {
  CHECK_THROWS_AS(parallel::for_each(0, 10,
                                     [](std::size_t i) {
                                       if (i == 7) throw std::runtime_error("seven");
                                     }),
                  std::runtime_error);
  CHECK_THROWS_AS(parallel::both([] {}, [] { throw std::runtime_error("other"); }), std::runtime_error);
  auto beside = parallel::beside([]() -> int { throw std::runtime_error("beside"); });
  CHECK_THROWS_AS(beside.get(), std::runtime_error);
  auto answer = parallel::beside([] { return 42; });
  CHECK(answer.get() == 42);
}
