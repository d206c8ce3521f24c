#pragma once
// Welch's method on a stream, for a fixed segment length.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/core/process/shared_blocks.hpp"
#include "libchar/spectrum/welch.hpp"
#include "libchar/spectrum/welch_sums.hpp"

namespace libchar {

/// welch(), streaming, for a fixed segment length (options.segment > 0): the same bits however the
/// samples are pushed, in the memory of a few segments. `finish` throws Error(numeric) when no
/// whole segment was seen, and may be called at any time.
class WelchStream {
 public:
  /// `workspace`: shared with other streams, and needed while this one is made only; none: memory of its own.
  explicit WelchStream(const WelchOptions& options, WelchWorkspace* workspace = nullptr);
  /// One that has seen a record elsewhere, part by part; no more samples come.
  WelchStream(const WelchOptions& options,
              const WelchSums& sums,
              WelchWorkspace* workspace = nullptr);
  void push(std::span<const double> samples);
  Spectrum finish(double rate_hz) const;

  /// Length of the blocks that this stream can share: half a segment when the spectrum goes by
  /// halves, each transformed once, so that the cosine transform of a half costs next to nothing.
  /// 0: it goes by segments and shares nothing.
  std::uint64_t shared_length() const;
  /// `push`, with every half offered as a block of `shared_length` samples. Either all samples of
  /// a stream are pushed with the same `blocks` or all without.
  void push(std::span<const double> samples, SharedBlocks& blocks);
  /// No more samples come: a half that waited for its partner is offered too, and `blocks` closed.
  void end(SharedBlocks& blocks);

  /// What it has found so far of a part of a record, but for `head` and `tail` (welch_sums.hpp).
  WelchSums sums() const;

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar
