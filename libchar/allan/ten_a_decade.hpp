#pragma once
// Averaging times between the octaves of a curve, for plots: ten a decade.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"

namespace libchar {

namespace detail {
/// Factors between octaves whose terms start every sample: an `allan_deviation` that also takes them
/// (more_factors) sums the record once for both.
std::vector<std::uint64_t> exact_factors(const AllanOptions& options,
                                         double dt_s,
                                         std::uint64_t samples);
}  // namespace detail

/// Adds m = round(10^(i/10)) to a curve of octaves (oadev) of this record, between `tau_min_s` and
/// `tau_max_s`. From m = 16 on terms start every m/16 to m/8 samples, which costs a hundredth of
/// the degrees of freedom; m is rounded to that. Records longer than `exact_samples` get none below
/// m = 64; records with missing samples exact ones, or none. `exact`: points at
/// `exact_factors`, where they are there already.
void add_ten_a_decade(std::span<const double> record,
                      const AllanOptions& options,
                      std::uint64_t exact_samples,
                      AllanCurve& octaves,
                      std::span<const AllanPoint> exact = {});

}  // namespace libchar
