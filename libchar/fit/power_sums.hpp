#pragma once
// The squared DCT-II coefficients of a part of a record, and how the parts of neighbours become those of both.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libchar/core/shared_blocks.hpp"
#include "libchar/core/state_archive.hpp"
#include "libchar/fit/power_bins.hpp"

namespace libchar {

/// Samples between two long gaps of a part, the missing ones closed up; or only missing ones, at the end of a part.
struct PowerRun {
  std::uint64_t gap = 0;      ///< missing samples in front
  std::uint64_t samples = 0;  ///< not missing
  double shift = 0;           ///< the first of them
  /// sqrt(512) * (mean of 512 samples less `shift`); what is left behind them is in none
  std::vector<double> means;
};

/// Sums of c_k² of transforms of one length.
struct PooledSums {
  std::uint64_t transforms = 0;
  std::vector<double> power;  ///< [k]; none: no transform
};

struct PowerSums {
  PooledSums blocks;
  std::array<PooledSums, 4> pieces;  ///< of 16384, 8192, 4096 and 2048 samples
  std::vector<PowerRun> runs;
  std::vector<double> tail;  ///< samples behind the last block of the record's last part
};

/// One part of a record, as PowerBinner takes a record: in blocks of `kBlock`, whose squares a stage that transforms them anyway may
/// add up.
class PowerPart final : public BlockTaker {
 public:
  static constexpr std::uint64_t kBlock = std::uint64_t{1} << 15U;

  PowerPart();
  ~PowerPart() override;
  void push(std::span<const double> samples) override;
  bool take_block(std::span<const double> samples) override;
  void take_power(std::vector<double> power) override;
  /// `last`: no part follows, so that what is left behind its last block is the record's tail. The object is done.
  PowerSums finish(bool last);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Adds the part that follows directly.
void join(PowerSums& sums, PowerSums later);

/// A binner that has seen the record. The sums are used up: the series of means of a long record does not stand in memory twice.
PowerBinner binner_of(PowerSums sums);

/// The means are let go of as they are written.
void write_state(PowerSums sums, StateWriter& to);
PowerSums read_power_sums(StateReader& from);

}  // namespace libchar
