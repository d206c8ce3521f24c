#pragma once
// The squared DCT-II coefficients of a part of a record, and how the parts of neighbours become those of both.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/core/numeric/state_archive.hpp"
#include "libchar/core/process/shared_blocks.hpp"
#include "libchar/fit/record/pooled_sums.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "libchar/fit/signs/event.hpp"

namespace libchar::detail {

/// Samples between two long gaps of a part, the missing ones closed up; or only missing ones, at the end of a part.
struct PowerRun {
  std::uint64_t gap = 0;      ///< missing samples in front
  std::uint64_t samples = 0;  ///< not missing
  double shift = 0;           ///< the first of them
  /// sqrt(512) * (mean of 512 samples less `shift`); what is left behind them is in none
  std::vector<double> means;
  /// in place of `means` where these are settled: 512 * (mean of 2^18 samples less `shift`)
  std::vector<double> slow;
  std::uint64_t at = 0;    ///< place of the first sample in the part
  std::uint64_t rows = 0;  ///< from the first sample to the last, missing ones too
};

struct PowerSums {
  std::uint64_t rows = 0;  ///< samples, missing ones too
  PooledSums blocks;
  std::array<PooledSums, 4> pieces;  ///< of 16384, 8192, 4096 and 2048 samples
  MeanPowers means;                  ///< of what is settled
  std::vector<PowerRun> runs;
  std::vector<double> tail;  ///< samples after the last block of the record's last part
};

/// One part of a record: in blocks of `kBlock`, whose squares a stage that transforms them anyway may add up.
class PowerPart final : public BlockTaker {
 public:
  static constexpr std::uint64_t kBlock = std::uint64_t{1} << 15U;

  PowerPart();
  void push(std::span<const double> samples) override;
  bool take_block(std::span<const double> samples) override;
  void take_power(std::vector<double> power) override;
  /// `last`: no part follows, so that what is left after its last block is the record's tail. The object is done.
  PowerSums finish(bool last);

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// Adds the part that follows directly.
void join(PowerSums& sums, PowerSums later);

/// The series of means of a part of 2^29 samples becomes powers of its blocks and a slow series: nothing grows with a
/// record but one value for 2^18 samples. `samples_before`: before the part, present or missing; a gap inside it
/// that is longer than a hundredth of those ends a segment.
void settle_means(PowerSums& sums, std::uint64_t samples_before);

/// Of the record times a factor.
void scale(PowerSums& sums, double factor);

/// The powers of the record. `events` are taken out of the series of means sample by sample, and
/// out of the powers of blocks by their energy.
std::vector<PooledPower> powers_of(PowerSums sums, std::span<const Event> events = {}, double rate_hz = 1);

void write_state(const PowerSums& sums, StateWriter& to);
PowerSums read_power_sums(StateReader& from);

}  // namespace libchar::detail

namespace libchar {
using namespace detail;
}
