#pragma once
// The inner loops of AllanPyramid: squared second differences of sums of 1, 2 and 4 neighbours, and
// pair sums.

#include <cstddef>

namespace libchar {

/// sum over i of (z_{i+4}+…+z_{i+7} - z_i-…-z_{i+3})^2, i = 0 … n - 8; differences are taken before
/// sums, so that an offset of z costs nothing. Eight lanes, i in lane i mod 8.
double squares_of_four(const double* z, std::size_t n);

/// The same for sums of 1, 2 and 4 in one pass: out[0] += …, out[1] += …, out[2] += …
void squares_of_one_two_four(const double* z, std::size_t n, double out[3]);

/// pair[i] = (z_{2i} - origin) + (z_{2i+1} - origin), i = 0 … pairs - 1.
void sum_pairs(const double* z, std::size_t pairs, double origin, double* pair);

/// Whether all n values are finite.
bool all_finite(const double* z, std::size_t n);

}  // namespace libchar
