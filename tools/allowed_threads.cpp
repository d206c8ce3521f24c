#include "allowed_threads.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <latch>
#include <system_error>
#include <thread>
#include <vector>

namespace sensorchar {
namespace {

bool given(int threads) {
  std::latch all_tried(1);
  std::vector<std::jthread> tried;
  tried.reserve(static_cast<std::size_t>(threads));
  bool refused = false;
  try {
    while (tried.size() < static_cast<std::size_t>(threads))
      tried.emplace_back([&] { all_tried.wait(); });
  } catch (const std::system_error&) {
    refused = true;
  }
  all_tried.count_down();
  return !refused;
}

bool address_space_is_limited() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace

std::unique_ptr<tbb::global_control> keep_to_allowed_threads() {
  const bool limited = address_space_is_limited();
  // A heap a thread takes 64 MB of addresses each, and where there are none left every allocation tries again.
  if (limited) mallopt(M_ARENA_MAX, 1);
  // Those of TBB, and the one that reads ahead.
  const int threads = tbb::info::default_concurrency();
  if (!given(threads))
    return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, 1);
  if (limited) tbb::parallel_for(0, 4 * threads, [](int) {});
  return nullptr;
}

}  // namespace sensorchar
