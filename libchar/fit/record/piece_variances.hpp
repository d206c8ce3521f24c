#pragma once
// The Allan variance of the pieces of a record at every octave that fits a piece sixteen times: is
// it the same throughout?

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/allan/allan_sums.hpp"
#include "libchar/core/numeric/state_archive.hpp"

namespace libchar {

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

/// The Allan sums of a leaf, and its pieces'.
AllanSums sums_of_pieces(std::span<const double> leaf, PieceVariances& pieces);

/// Adds those of the part that follows directly.
void join(PieceVariances& pieces, const PieceVariances& later);

void write_state(const PieceVariances& pieces, StateWriter& to);
PieceVariances read_piece_variances(StateReader& from);

}  // namespace libchar
