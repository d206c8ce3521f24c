#pragma once
// A shape of the top of the spectrum that is too small to be seen and large enough to matter.

#include <vector>

#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

struct Band;

/// Log gain amplitude * sin(pi f / rate)^(2 power).
struct SmallShape {
  int power = 1;
  double amplitude = 0;
  bool seen = false;  ///< large enough to be a part of what is reported, too
};

/// Its mean over a bin.
double small_shape_log_gain(const SmallShape& shape, const PowerBin& bin, double rate_hz);

/// Puts the most probable one beside all `terms` into a band, where it is larger than its standard
/// deviation. Returns how many of them it is; 0: none was put there.
double take_small_shape(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms, Band& band);

/// Averages the coefficients of `fit`, with their covariance and intervals, over small shapes of
/// the top of the spectrum. `problem` and `best`: the likelihood of the bins inside the band, the
/// band's own small shape in it, and its maximum.
void average_over_small_shapes(const std::vector<PowerBin>& bins, const Band& band, const BinProblem& problem,
                               const ModelPoint& best, NoiseFit& fit);

}  // namespace libchar
