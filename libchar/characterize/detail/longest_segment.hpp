#pragma once
#include "libchar/core/process/progress.hpp"
#include "libchar/log/read.hpp"

namespace libchar {

/// A segment of `samples`, or of `seconds` where that is 0, before anything is set up for it: throws
/// Error(usage) where the log is shorter, with
/// the longest that fits. Only where the segment is so long that setting it up takes long is the log read for that.
void refuse_longer_segment(const std::string& path,
                           const ReadOptions& reading,
                           std::uint64_t samples,
                           double seconds,
                           Progress& progress);

}  // namespace libchar
