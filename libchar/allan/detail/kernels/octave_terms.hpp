#pragma once
// Terms of one averaging factor of the pyramid, one by one: at the ends of blocks, and where something is missing.

#include <cstddef>

#include "libchar/allan/allan_sums.hpp"

namespace libchar {

/// Sums of what is present, less the first sample of the record, and how many each lacks of `size`.
struct Holed {
  const double* sum;
  const double* absent;
  double size;
};

/// Terms of sums of `width` neighbours that start in z[0], z[1] …, touching nothing missing; z
/// scaled so that squares are safe. `squares` are those of differences of sums, not of means.
void add_one_by_one(const double* z, std::size_t n, std::size_t width, double scale, PresentTerms& tally);

/// The same where something may be missing: differences of means over what is present, times m.
void add_present(const Holed& z, std::size_t n, std::size_t width, double scale, PresentTerms& tally);

/// Samples with NaN as sums of one, less `origin`, and which of them are missing.
void split_present(const double* x, std::size_t n, double origin, double* sum, double* absent);

bool any_absent(const double* absent, std::size_t n);

/// A power of two that brings the largest deviation of the block near 1.
double block_scale(const double* z, std::size_t n);

// The inner loops of AllanPyramid: squared second differences of sums of 1, 2 and 4 neighbours, and pair sums.

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
