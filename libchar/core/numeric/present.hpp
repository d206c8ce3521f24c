#pragma once
// Where a record has its samples: NaN marks a missing one.

#include <cstddef>
#include <span>

namespace libchar {

/// Beyond it a sample is not a measurement, and its powers would overflow: it counts as missing.
inline constexpr double kLargestSample = 1e100;

/// Samples that are present and beyond it.
std::size_t count_beyond(std::span<const double> samples);

/// How many samples from the first on are present.
std::size_t present_run(std::span<const double> samples);

/// The same, where an infinity counts as missing too.
std::size_t finite_run(std::span<const double> samples);

std::size_t count_missing(std::span<const double> samples);

struct PresentMean {
  double mean = 0;
  std::size_t count = 0;  ///< of finite ones
};

/// Mean of the finite ones, about the first of them: an offset costs no digits. NaN where there is none; at least one
/// sample.
PresentMean present_mean(std::span<const double> samples);
/// The mean alone.
double mean_present(std::span<const double> samples);

}  // namespace libchar
