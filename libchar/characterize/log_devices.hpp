#pragma once
// Of the channels of a log: single devices from their differences, and deviations as they change in time.

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

struct LogAllanOptions {
  ReadOptions reading;
  SampleKind data = SampleKind::rate;
  double nominal_frequency = 0;  ///< as in CharacterizeOptions
  AllanOptions allan;
};

struct LogHat {
  LogInfo log;
  std::vector<Channel> channels;  ///< the devices
  CorneredHat hat;
};

/// Three or more channels that measure the same at once: the deviation of each. `differences`: three channels are a -
/// b, b - c and c - a instead, and the devices are called after them. Reads the log whole. Throws as read_recording and
/// cornered_hat.
LogHat log_cornered_hat(const std::string& path, const LogAllanOptions& options, bool differences,
                        Progress& progress = no_progress());

struct LogDynamic {
  LogInfo log;
  std::vector<Channel> channels;
  std::vector<DynamicDeviation> deviations;  ///< a channel each
};

struct DynamicTimes {
  double window_s = 0, step_s = 0;  ///< step 0: half a window
};

/// Reads the log whole. Throws as read_recording and dynamic_deviation.
LogDynamic log_dynamic_deviation(const std::string& path, const LogAllanOptions& options, const DynamicTimes& times,
                                 Progress& progress = no_progress());

}  // namespace libchar
