#pragma once
// Sums of squared differences over contiguous samples: eight partial sums in fixed order, so that
// the bits do not depend on the vector width the processor has.

#include <cstdint>

namespace libchar {

/// d_t = c0 + c1 t + c2 t^2 + (second or third difference of at[0][t], at[1][t], …), t = 0, stride,
/// 2 stride, …
struct DifferenceRun {
  const double* at[4] = {};
  double c[3] = {};
  std::uint64_t count = 0;
  std::uint64_t stride = 1;
};

double squared_second_differences(const DifferenceRun& run);
double squared_third_differences(const DifferenceRun& run);

}  // namespace libchar
