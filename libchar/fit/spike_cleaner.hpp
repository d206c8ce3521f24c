#pragma once
// Isolated outliers of a stream of samples, replaced and counted.

#include <cstdint>
#include <span>
#include <vector>

namespace libchar {

/// Takes samples in pieces of any size and gives them back cleaned, two samples late, the same
/// whatever the pieces. The limit comes from a pilot (the first samples are held back until it is
/// full), or is given.
class SpikeCleaner {
 public:
  explicit SpikeCleaner(double mad_limit = 6, std::size_t pilot = 16384);
  /// A cleaner with a known limit on |y - (y₋+y₊)/2|, in the channel's unit; 0 cleans nothing.
  static SpikeCleaner with_limit(double limit);

  /// Cleaned samples that became certain; valid until the next call.
  std::span<const double> push(std::span<const double> samples);
  /// The last ones. The cleaner is empty afterwards and keeps its limit and count.
  std::span<const double> finish();

  std::uint64_t count() const { return count_; }
  double limit() const { return limit_; }

 private:
  void release(bool last);
  double mad_limit_;
  std::size_t pilot_;
  double limit_ = -1;  ///< < 0: the pilot is still being filled
  std::uint64_t count_ = 0;
  /// held_[0] is the neighbour before the next sample, given out already
  bool has_before_ = false;
  std::vector<double> held_, ready_;
};

/// The limit for a record: `mad_limit` robust standard deviations of the three-sample residual,
/// from at most 65536 places spread over the record; 0 when more than half of the residuals are
/// equal (a coarse grid), where no limit makes sense.
double spike_limit(std::span<const double> record, double mad_limit);

/// Spikes: 3-sample test y - (y₋+y₊)/2 beyond 6 MAD, local maximum, replaced by the mean of its neighbours. Returns the count.
std::uint64_t clean_spikes(std::span<double> record, double mad_limit = 6);

}  // namespace libchar
