#include "libchar/spectrum/detail/fft_plan.hpp"

#include <fmt/format.h>

#include <limits>
#include <list>
#include <new>

#include "libchar/core/refusal.hpp"

namespace {

bool planner_is_broken = false;  // under the planner's mutex: who plans holds it

}  // namespace

// FFTW asserts that its planner gets memory, and an assertion that fails ends the process; this
// stands in its place. Nothing else of FFTW asserts anything in a release build. What the planner
// held is lost, and half of it may be changed.
extern "C" void fftw_assertion_failed(const char*, int, const char*) {
  planner_is_broken = true;
  throw std::bad_alloc();
}

namespace libchar::fft_plan {
namespace {

std::recursive_mutex& planner_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// A transform of more bytes may be what takes the memory.
constexpr std::size_t kLong = std::size_t{64} << 20U;

/// All lengths together: a plan's own tables take about as much as its values.
constexpr std::size_t kMostKept = std::size_t{1} << 21U;

struct KeptPlan {
  Kind kind{};
  std::size_t n = 0;
  Plan plan;
};

/// Those used last come first. Like the planner's own memory of plans it changes no result: of one
/// length there is one plan.
std::list<KeptPlan>& kept_plans() {
  static std::list<KeptPlan> kept;
  return kept;
}

void keep_to_room() {
  std::list<KeptPlan>& kept = kept_plans();
  std::size_t sum = 0;
  auto at = kept.begin();
  while (at != kept.end() && (sum += at->n) <= kMostKept) ++at;
  kept.erase(at, kept.end());
}

}  // namespace

void* allocated(std::size_t values, std::size_t bytes_each) {
  void* memory =
      values <= std::numeric_limits<std::ptrdiff_t>::max() / bytes_each ? fftw_malloc(values * bytes_each) : nullptr;
  if (memory == nullptr && values < kLong / bytes_each) throw std::bad_alloc();
  if (memory == nullptr)
    throw numeric_error("E0403").says("not enough memory for a Fourier transform of {} values", values);
  return memory;
}

std::recursive_mutex& planner() {
  const std::lock_guard lock(planner_mutex());
  if (planner_is_broken) throw std::bad_alloc();
  return planner_mutex();
}

Plan owned(fftw_plan plan) {
  if (plan == nullptr) throw std::bad_alloc();
  return {plan, [](fftw_plan gone) {
            const std::lock_guard lock(planner_mutex());
            if (!planner_is_broken) fftw_destroy_plan(gone);
          }};
}

Plan planned(Kind kind, std::size_t n, const std::function<fftw_plan()>& make) {
  const std::lock_guard lock(planner());
  std::list<KeptPlan>& kept = kept_plans();
  for (auto at = kept.begin(); at != kept.end(); ++at)
    if (at->kind == kind && at->n == n) {
      kept.splice(kept.begin(), kept, at);
      return at->plan;
    }
  kept.push_front({kind, n, owned(make())});
  Plan plan = kept.front().plan;
  keep_to_room();
  return plan;
}

}  // namespace libchar::fft_plan
