#pragma once
// What the disagreement of sensors is made of.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar::fusion {

/// Parts of the mean square of a channel's error, in the order in which they are taken out.
enum class ErrorPart { offset, gain, cross, delay, jitter, noise };
inline constexpr std::size_t kErrorParts = 6;

struct PartShare {
  double share = 0;   ///< of the channel's mean square error
  Interval ci95;      ///< by batches; NaN: too few
  double saving = 0;  ///< share of the fused error (its RMS) that would go if this were gone here
};

struct ChannelBudget {
  double rms = 0;  ///< of the channel's error; NaN: none
  std::vector<PartShare> parts;
};

struct ErrorBudget {
  std::vector<ChannelBudget> channels;
  std::vector<double> savings;  ///< One per part: if it were gone from every channel.
  /// RMS of the mean's error (with a truth), or of the mean of the others against each channel (blind),
  /// on the same instants: as recorded, and aligned.
  double before = 0, after = 0;
  std::int64_t instants = 0;
};

}  // namespace libchar::fusion
