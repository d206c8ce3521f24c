#pragma once
// Parallel first-order sections, four in a vector.

#include <cstddef>
#include <span>

namespace libchar {

struct Sections {
  const double* loss;
  const double* weight;
  double* state;
  std::size_t vectors;  ///< of four sections
};

/// x_j += weight_j g - loss_j x_j for every value g, which is replaced by sum_j x_j - level. The
/// same bits with and without AVX, whatever the number of values a call.
void run_sections(const Sections& sections, double level, std::span<double> values);

}  // namespace libchar
