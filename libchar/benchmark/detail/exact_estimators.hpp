#pragma once
// The estimators' definitions, term by term in long double (64 bits of mantissa or more): what
// their fast forms are held against.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/allan/deviation_types.hpp"

namespace libchar {

using Exact = long double;

/// A deviation of a record of rate without missing samples at m, tau = m dt; terms start at multiples of `stride`.
Exact exact_deviation(std::span<const double> y,
                      double dt_s,
                      DeviationType type,
                      std::uint64_t m,
                      std::uint64_t stride);

/// Mean and standard deviation (n - 1).
std::vector<Exact> exact_moments(std::span<const double> y);

/// One-sided density by Welch's method: Hann, half overlap, means taken off segment by segment.
std::vector<Exact> exact_welch(std::span<const double> y, double rate_hz, std::size_t segment);

/// Orthonormal DCT-II of the record without its mean; c_0 is left at zero.
std::vector<Exact> exact_cosine_transform(std::span<const double> y);

/// Weights that sum to one and make the sum of squares of sum w_i e_i least, of n x N errors.
std::vector<Exact> exact_weights(const std::vector<std::vector<double>>& errors);

}  // namespace libchar
