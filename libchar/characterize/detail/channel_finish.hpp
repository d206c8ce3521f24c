#pragma once
// What was found of a channel becomes its result: curves, fit, and why something is absent.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/detail/leaf.hpp"
#include "libchar/fit/curve/allan_fit.hpp"
#include "libchar/spectrum/welch_stream.hpp"

namespace libchar {

/// What the channels of one log share, from any number of threads.
struct CharacterizeWorkspace {
  FitWorkspace fit;
  WelchWorkspace welch;
};

/// A channel that has been read.
struct ReadChannel {
  /// of a log of one leaf its samples alone
  ChannelSums sums;
  /// all samples of a longer log as it has them, where something needs them
  std::vector<double> all;
  /// of a longer log whose spectrum is not one of leaves
  std::optional<WelchStream> spectrum;
  std::shared_ptr<const TemperatureRecord> temperature;  ///< of the log; null: none was asked for
};

/// Curves and fit. `rate_hz` > 0, or nothing that needs a time axis is computed and the result says
/// why.
ChannelResult finish_channel(ReadChannel read,
                             const CharacterizeOptions& options,
                             CharacterizeWorkspace& workspace,
                             const Channel& channel,
                             double rate_hz);

}  // namespace libchar
