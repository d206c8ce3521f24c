#pragma once
// A recording with uneven stamps, interpolated to an even grid: filters that integrate over time
// need the time that really passed.

#include <string>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/log/read.hpp"

namespace libchar {

struct ResampledLog {
  LogInfo log;                               ///< of the file as it is; rate and samples are those of the even grid
  std::vector<std::vector<double>> samples;  ///< [wanted channel][instant], NaN: missing
};

/// Linear between a channel's neighbouring samples by their stamps; missing where these are more than four of the
/// channel's median steps apart. Rows whose stamp does not advance are left out and counted. Whole in memory. Wanted
/// channels from `first_angle` on are angles, joined the short way round. Throws Error(input) for a log without stamps.
ResampledLog read_resampled(const std::string& path, const ReadOptions& reading, const std::vector<std::string>& wanted,
                            double rate_hz, std::size_t first_angle, Progress& progress);

}  // namespace libchar
