#pragma once
// The stretch of a log that is analysed where only rest is wanted: as the caller says, or the
// longest in which no channel moves.

#include <memory>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/fit/record/mean_meter.hpp"

namespace libchar {

/// Sees a whole log and says which stretch of it is still.
class StillSearch final : public BlockSink {
 public:
  void begin(const LogInfo& so_far) override;
  void block(const SampleBlock& samples) override;
  /// Throws Error(numeric) where the log moves throughout, or cannot be searched.
  Stretch finish(const LogInfo& log) const;

 private:
  std::vector<MeanMeter> means_;
};

/// The stretch that `options` ask for is read: of a window in the options, Error(usage); ends that
/// are none, Error(usage).
void check_still(const StillOptions& still, const ReadOptions& reading);

/// "Only the stretch from 38.6 to 186 s was analysed, the longest in which nothing moves."
std::string stretch_sentence(const Stretch& stretch);

}  // namespace libchar
