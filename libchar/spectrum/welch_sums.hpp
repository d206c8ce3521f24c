#pragma once
// What Welch's method has found of a part of a record, and how the parts of neighbours become that of both.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/core/numeric/state_archive.hpp"
#include "libchar/core/process/shared_blocks.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {

struct WelchSums {
  std::uint64_t samples = 0, used = 0, dropped = 0;         ///< segments
  std::vector<double> power;                                ///< sums over them; none: no segment
  std::vector<std::uint64_t> pairs;                         ///< [lag]: pairs of used segments so many hops apart
  std::vector<unsigned char> begin, end;                    ///< was it used: of as many segments as overlap one
  std::vector<double> head, tail;                           ///< samples of a segment less a hop, or all there are
  double first = std::numeric_limits<double>::quiet_NaN();  ///< sample that is there
  bool moves = false, moves_little = false;                 ///< do others differ from it
};

/// Takes parts of a record and joins them. Parts begin at whole hops: all but the last are a
/// multiple of a hop long, and not shorter than a segment less a hop.
class WelchParts {
 public:
  /// `options.segment` > 0. `workspace`: shared with others, and must live as long.
  explicit WelchParts(const WelchOptions& options, WelchWorkspace* workspace = nullptr);

  /// "" or why records cannot be divided into parts of this many samples, as a sentence without its end.
  static std::string why_not(const WelchOptions& options, std::uint64_t part);

  /// Length of the blocks that are shared with another stage; 0: none are.
  std::uint64_t shared_length() const;
  /// One part. `taker`: gets its samples, blocks of `shared_length` among them; none: nobody does.
  WelchSums take(std::span<const double> part, BlockTaker* taker = nullptr) const;
  /// Adds the part that follows directly (WelchStream makes a spectrum of the sums), and the
  /// segments that straddle the boundary.
  void join(WelchSums& sums, const WelchSums& later);

  static void write_state(const WelchSums& sums, StateWriter& to);
  WelchSums read_state(StateReader& from) const;

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// Squared cosine transforms of blocks of half a segment, with the bits that WelchParts gives them, where
/// no spectrum is wanted.
class BlockTransforms {
 public:
  /// `block`: half a segment that Welch's method takes by halves. `workspace`: as of WelchParts.
  explicit BlockTransforms(std::uint64_t block, WelchWorkspace* workspace = nullptr)
      : block_(block), workspace_(workspace) {}
  /// One part of a record.
  void take(std::span<const double> part, BlockTaker& taker) const;

 private:
  std::uint64_t block_ = 0;
  WelchWorkspace* workspace_ = nullptr;
};

// Welch's method on a stream, for a fixed segment length.

/// welch(), streaming, for a fixed segment length (options.segment > 0): the same bits however the
/// samples are pushed, in the memory of a few segments. `finish` throws Error(numeric) when no
/// whole segment was seen, and may be called at any time.
class WelchStream {
 public:
  /// `workspace`: shared with other streams, and needed while this one is made only; none: memory of its own.
  explicit WelchStream(const WelchOptions& options, WelchWorkspace* workspace = nullptr);
  /// One that has seen a record elsewhere, part by part; no more samples come.
  WelchStream(const WelchOptions& options, const WelchSums& sums, WelchWorkspace* workspace = nullptr);
  void push(std::span<const double> samples);
  Spectrum finish(double rate_hz) const;

  /// Length of the blocks that this stream can share: half a segment when the spectrum goes by halves, each transformed
  /// once, so that the cosine transform of a half costs next to nothing. 0: it goes by segments and shares nothing.
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
