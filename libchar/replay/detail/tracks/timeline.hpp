#pragma once
// Values over time, thinned for reports: no extreme is lost.

#include <span>
#include <vector>

#include "libchar/replay/error_meter.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

inline constexpr std::size_t kTrackBins = 400;
inline constexpr std::size_t kWindowBins = 800;

/// Points (time_s rising) of several series in at most `bins` bins. Empty when no series ever
/// changes.
Timeline thinned(std::span<const double> time_s,
                 const std::vector<std::vector<double>>& series,
                 std::size_t bins);

/// RMS of the error in a window of `window_s` centred on each instant, shorter at both ends. [RV]
/// takes the same window and loses the ends. Computed on the meter's cells: the
/// window is rounded to a whole number of them.
Timeline window_rms(const ErrorMeter& meter, double rate_hz, double start_s, double window_s);

}  // namespace libchar
