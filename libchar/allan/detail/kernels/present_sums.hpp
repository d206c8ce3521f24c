#pragma once
// Running sums over what is present of a record with missing samples.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/allan/detail/kernels/missing_samples.hpp"

namespace libchar {

struct PresentSums {
  double scale = 1;  ///< power of two by which all was multiplied
  std::vector<long double>
      sum;  ///< of the samples present before each, less the first of the record; one more than samples
  std::vector<std::uint64_t> present;  ///< how many these are
};

PresentSums present_sums(std::span<const double> record);

/// Terms with starts first, first + stride, … < last: differences of `order` of neighbouring
/// windows' means, order 1 (Allan) or 2 (Hadamard), of windows of m samples that the record holds.
PresentTerms present_terms(const PresentSums& sums,
                           int order,
                           std::uint64_t m,
                           std::uint64_t first,
                           std::uint64_t last,
                           std::uint64_t stride);

/// Every term of the modified variance: the mean of the Allan terms at m starts in a row, all of which there must be.
PresentTerms modified_terms(const PresentSums& sums, std::uint64_t m);

}  // namespace libchar
