#pragma once
// All that a fit needs of a record of any length: sums over its leaves (core/leaf_tree.hpp), which join.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/allan/allan_sums.hpp"
#include "libchar/core/numeric/leaf_tree.hpp"
#include "libchar/core/numeric/state_archive.hpp"
#include "libchar/fit/record/mean_meter.hpp"
#include "libchar/fit/record/power_sums.hpp"
#include "libchar/fit/signs/spike_cleaner.hpp"
#include "libchar/spectrum/welch_sums.hpp"

namespace libchar::detail {

// The Allan variance of the pieces of a record at every octave that fits a piece sixteen times: is
// it the same throughout?

/// Averaging times in a piece, at least.
inline constexpr std::uint64_t kWindowsOfPiece = 16;

/// At octave j (m = 2^j) of consecutive pieces of `length(j)` samples, from the record's first on.
/// What fills no piece is in none.
struct PieceVariances {
  static constexpr std::uint64_t kShortest = std::uint64_t{1} << 14U;

  std::uint64_t shortest = kShortest;         ///< piece; a power of two
  std::vector<std::vector<double>> variance;  ///< [j][piece]; NaN: none, of missing samples

  std::uint64_t length(std::size_t octave) const;
};

/// Adds those of the part that follows directly.
void join(PieceVariances& pieces, const PieceVariances& later);

void write_state(const PieceVariances& pieces, StateWriter& to);

/// Of the samples as they are, or without spikes.
struct FittedSums {
  AllanSums allan;
  PowerSums bins;
  MeanMeter means;
  PieceVariances pieces;
};

struct RecordSums {
  FittedSums plain;
  /// without the spikes of the leaves that have some; none: no leaf has, and these would be `plain`
  std::optional<FittedSums> cleaned;
  SpikeCount spikes;
};

struct LeafKind {
  bool last = false;    ///< no leaf follows
  bool bridged = true;  ///< short runs of missing samples are filled for the transforms
  bool whole = false;   ///< none is missing
};
MeanMeter means_of_leaf(std::span<const double> leaf);
/// `shared`: has seen the blocks of the leaf, which is whole, already. Else `blocks` transforms
/// them: so they have the same bits whether a spectrum shares them or not.
FittedSums fitted_sums(std::span<const double> leaf, const LeafKind& kind, const BlockTransforms& blocks,
                       PowerPart* shared = nullptr);
/// Adds the part that follows directly.
void join(RecordSums& sums, RecordSums later);
/// Of a node of the tree, what grows with the record is made less where the node is as long as that asks for.
void settle(RecordSums& sums, std::uint64_t height, std::uint64_t first_leaf);

/// Of the record times a factor.
void scale(RecordSums& sums, double factor);

/// Of samples in memory: `remedies` leaves spikes out and fills short runs of missing samples.
RecordSums record_sums(std::span<const double> record, bool remedies);

void write_state(const RecordSums& sums, StateWriter& to);
RecordSums read_record_sums(StateReader& from);

}  // namespace libchar::detail

namespace libchar {
using namespace detail;
}
