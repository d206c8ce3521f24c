#pragma once
// What a fit says of its band: residuals of every bin, the shape, and what was left out, in words.

#include "libchar/fit/detail/band/band.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

/// Fills residuals, band, shape and the corner of a low-pass. `best` is the maximum of `problem`, the bins inside the
/// band.
void describe_band(const std::vector<PowerBin>& bins, const Band& band, const BinProblem& problem,
                   const ModelPoint& best, double rate_hz, NoiseFit& fit);

/// Puts what was clipped as lines back into the shape: a simulation then has their power where the recording has it.
/// `clipped` are the bins that were fitted, `full` the same with every coefficient.
void add_lines(const std::vector<PowerBin>& clipped, const std::vector<PowerBin>& full, NoiseFit& fit);

/// The remedies that stand for the band's decisions.
void report_band(const Band& band, const std::vector<PowerBin>& bins, NoiseFit& fit);

/// B and K of a slow end that lies lower than they say.
void report_doubtful_end(NoiseFit& fit);

/// The finding, where the slow end is that of a high-pass, or the spectrum has two levels.
void report_corner(const Band& band, NoiseFit& fit);

/// The residuals inside the band.
std::vector<FitResidual> inside_of(const std::vector<FitResidual>& residuals);

}  // namespace libchar
