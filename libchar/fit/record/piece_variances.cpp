// A leaf is a binary tree of pieces of 2^14 samples, whose Allan sums are joined upwards: each node
// gives the octaves that fit it sixteen times and its halves do not. As a record grows, the
// shortest pieces become pairs, whose variance is the mean of both.
#include "libchar/fit/record/piece_variances.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/core/error.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostPieces = 512;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Octaves of a node that are not those of its halves.
void take_octaves(const AllanSums& sums, std::uint64_t samples, PieceVariances& pieces) {
  const std::size_t last = static_cast<std::size_t>(std::bit_width(samples / kWindowsOfPiece)) - 1;
  const std::size_t first = samples == PieceVariances::kShortest ? 0 : last;
  if (pieces.variance.size() <= last) pieces.variance.resize(last + 1);
  std::vector<double> found(last + 1, kNone);
  try {
    for (const AllanPoint& point : octave_curve(sums, 1).points)
      if (const auto j = static_cast<std::size_t>(std::bit_width(point.m)) - 1; j <= last)
        found[j] = point.deviation * point.deviation;
  } catch (const Error& error) {  // all of it is missing
    if (error.problem().kind != ErrorKind::numeric) throw;
  }
  for (std::size_t j = first; j <= last; ++j) pieces.variance[j].push_back(found[j]);
}

double mean_of_two(double a, double b) {
  if (std::isnan(a)) return b;
  return std::isnan(b) ? a : a + 0.5 * (b - a);
}

void double_shortest(PieceVariances& pieces) {
  for (std::size_t j = 0; j < pieces.variance.size(); ++j) {
    if (pieces.length(j) > pieces.shortest) break;
    std::vector<double>& v = pieces.variance[j];
    for (std::size_t i = 0; i + 1 < v.size(); i += 2) v[i / 2] = mean_of_two(v[i], v[i + 1]);
    v.resize(v.size() / 2);
  }
  pieces.shortest *= 2;
}

}  // namespace

std::uint64_t PieceVariances::length(std::size_t octave) const {
  return std::max(shortest, kWindowsOfPiece << octave);
}

AllanSums sums_of_pieces(std::span<const double> leaf, PieceVariances& pieces) {
  struct Node {
    std::uint64_t samples = 0;
    AllanSums sums;
  };
  std::vector<Node> nodes;
  const auto join_last = [&] {
    const Node later = std::move(nodes.back());
    nodes.pop_back();
    nodes.back().samples += later.samples;
    libchar::join(nodes.back().sums, later.sums);
  };
  for (std::span<const double> rest = leaf; !rest.empty();) {
    const std::span<const double> piece =
        rest.first(std::min<std::size_t>(rest.size(), PieceVariances::kShortest));
    rest = rest.subspan(piece.size());
    AllanPyramid pyramid;
    pyramid.push(piece);
    nodes.push_back({piece.size(), std::move(pyramid).sums()});
    if (piece.size() == PieceVariances::kShortest)
      take_octaves(nodes.back().sums, piece.size(), pieces);
    while (nodes.size() > 1 && nodes[nodes.size() - 2].samples == nodes.back().samples &&
           std::has_single_bit(nodes.back().samples / PieceVariances::kShortest)) {
      join_last();
      take_octaves(nodes.back().sums, nodes.back().samples, pieces);
    }
  }
  while (nodes.size() > 1) join_last();
  return nodes.empty() ? AllanSums{} : std::move(nodes[0].sums);
}

void join(PieceVariances& pieces, const PieceVariances& later_as_it_is) {
  PieceVariances later = later_as_it_is;
  while (pieces.shortest < later.shortest) double_shortest(pieces);
  while (later.shortest < pieces.shortest) double_shortest(later);
  if (pieces.variance.size() < later.variance.size()) pieces.variance.resize(later.variance.size());
  for (std::size_t j = 0; j < later.variance.size(); ++j)
    pieces.variance[j].insert(
        pieces.variance[j].end(), later.variance[j].begin(), later.variance[j].end());
  while (!pieces.variance.empty() && pieces.variance[0].size() > kMostPieces)
    double_shortest(pieces);
}

void write_state(const PieceVariances& pieces, StateWriter& to) {
  to.number(pieces.shortest);
  to.number(pieces.variance.size());
  for (const std::vector<double>& v : pieces.variance) to.reals(v);
}

PieceVariances read_piece_variances(StateReader& from) {
  PieceVariances pieces;
  pieces.shortest = from.number();
  pieces.variance.resize(from.count(8));
  for (std::vector<double>& v : pieces.variance) v = from.reals();
  if (!std::has_single_bit(pieces.shortest) || pieces.shortest < PieceVariances::kShortest ||
      pieces.variance.size() > 48)
    from.refuse("the pieces of a channel");
  return pieces;
}

}  // namespace libchar
