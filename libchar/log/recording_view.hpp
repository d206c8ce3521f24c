#pragma once
// A recording whose samples belong to somebody else: columns of a table in memory, arrays of another language.

#include <span>
#include <vector>

#include "libchar/log/recording.hpp"

namespace libchar {

/// The samples must live as long as it is used. A caller who makes one names `info.channels` and
/// `info.time.rate_hz` and leaves the rest as it is.
struct RecordingView {
  LogInfo info;
  std::vector<std::span<const double>> samples;  ///< samples[channel]; NaN is missing
};

inline RecordingView view_of(const Recording& recording) {
  return {recording.info, {recording.samples.begin(), recording.samples.end()}};
}
RecordingView view_of(Recording&&) = delete;

}  // namespace libchar
