#include "tests/support/kernels.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "libchar/core/process/sanitizer.hpp"

using namespace libchar;

namespace {

constexpr std::string_view kGroups[] = {"csv", "allan", "spectrum", "noise", "fusion"};

/// Slower than without the instructions by so much is a cliff, whatever else runs beside.
constexpr double kMostSlower = 1.3;

double slowest_ratio(const test::KernelTime& time) {
  return *std::max_element(time.seconds.begin(), time.seconds.end()) / time.seconds[0];
}

}  // namespace

TEST_CASE("kernels: every kind of instructions gives the same bits") {
  for (const std::string_view group : kGroups)
    for (const test::Kernel& kernel : test::kernels_of(group)) {
      INFO(kernel.name);
      const test::KernelTime time = test::time_of(kernel, 1);
      for (const double result : time.results) CHECK(result == time.results[0]);
    }
}

TEST_CASE("kernels: no kind of instructions that this processor has is slower than none") {
  if (LIBCHAR_SANITIZED_HEAP != 0) return;  // which slows each kind as it likes
  for (const std::string_view group : kGroups)
    for (const test::Kernel& kernel : test::kernels_of(group)) {
      INFO(kernel.name);
      double ratio = slowest_ratio(test::time_of(kernel));
      for (int again = 0; again < 3 && ratio > kMostSlower; ++again)
        ratio = std::min(ratio, slowest_ratio(test::time_of(kernel, 30)));
      CHECK(ratio <= kMostSlower);
    }
}
