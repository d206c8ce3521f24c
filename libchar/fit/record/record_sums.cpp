#include "libchar/fit/record/record_sums.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/fit/detail/band/bridge.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar::detail {

// A leaf is a binary tree of pieces of 2^14 samples, whose Allan sums are joined upwards: each node
// gives the octaves that fit it sixteen times and its halves do not. As a record grows, the
// shortest pieces become pairs, whose variance is the mean of both.

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

template <class Archive, class Pieces>
void pieces_layout(Archive& at, Pieces& pieces) {
  at(pieces.shortest);
  at.list(pieces.variance, 8, [&](auto& variances) { at(variances); });
}

PieceVariances read_piece_variances(StateReader& from) {
  PieceVariances pieces;
  pieces_layout(from, pieces);
  if (!std::has_single_bit(pieces.shortest) || pieces.shortest < PieceVariances::kShortest ||
      pieces.variance.size() > 48)
    from.refuse("the pieces of a channel");
  return pieces;
}

/// The Allan sums of a leaf, and its pieces'.
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
    join(nodes.back().sums, later.sums);
  };
  for (std::span<const double> rest = leaf; !rest.empty();) {
    const std::span<const double> piece = rest.first(std::min<std::size_t>(rest.size(), PieceVariances::kShortest));
    rest = rest.subspan(piece.size());
    AllanPyramid pyramid;
    pyramid.push(piece);
    nodes.push_back({piece.size(), std::move(pyramid).sums()});
    if (piece.size() == PieceVariances::kShortest) take_octaves(nodes.back().sums, piece.size(), pieces);
    while (nodes.size() > 1 && nodes[nodes.size() - 2].samples == nodes.back().samples &&
           std::has_single_bit(nodes.back().samples / PieceVariances::kShortest)) {
      join_last();
      take_octaves(nodes.back().sums, nodes.back().samples, pieces);
    }
  }
  while (nodes.size() > 1) join_last();
  return nodes.empty() ? AllanSums{} : std::move(nodes[0].sums);
}

}  // namespace

std::uint64_t PieceVariances::length(std::size_t octave) const { return std::max(shortest, kWindowsOfPiece << octave); }

void join(PieceVariances& pieces, const PieceVariances& later_as_it_is) {
  PieceVariances later = later_as_it_is;
  while (pieces.shortest < later.shortest) double_shortest(pieces);
  while (later.shortest < pieces.shortest) double_shortest(later);
  if (pieces.variance.size() < later.variance.size()) pieces.variance.resize(later.variance.size());
  for (std::size_t j = 0; j < later.variance.size(); ++j)
    pieces.variance[j].insert(pieces.variance[j].end(), later.variance[j].begin(), later.variance[j].end());
  while (!pieces.variance.empty() && pieces.variance[0].size() > kMostPieces) double_shortest(pieces);
}

void write_state(const PieceVariances& pieces, StateWriter& to) { pieces_layout(to, pieces); }

namespace {

constexpr std::uint64_t kSettledHeight = 9;  ///< of nodes whose means are settled: 2^29 samples
constexpr std::uint64_t kPerMean = 32;       ///< as many means of a leaf as a search looks at

void join(FittedSums& sums, FittedSums later) {
  join(sums.allan, later.allan);
  join(sums.bins, std::move(later.bins));
  sums.means.join(std::move(later.means));
  join(sums.pieces, later.pieces);
}

void add_count(const SpikeCount& later, SpikeCount& count) {
  count.samples += later.samples;
  count.left_out += later.left_out;
  count.spikes += later.spikes;
  count.shoulder += later.shoulder;
  count.steps += later.steps;
  count.crowded += later.crowded;
  count.log_size += later.log_size;
}

void scale_fitted(FittedSums& sums, double factor) {
  scale(sums.allan, factor);
  scale(sums.bins, factor);
  sums.means.scale(factor);
  for (std::vector<double>& octave : sums.pieces.variance)
    for (double& variance : octave) variance *= factor * factor;
}

void write_fitted(const FittedSums& sums, StateWriter& to) {
  write_state(sums.allan, to);
  write_state(sums.bins, to);
  sums.means.write_state(to);
  write_state(sums.pieces, to);
}

FittedSums read_fitted(StateReader& from) {
  FittedSums sums;
  sums.allan = read_allan_sums(from);
  sums.bins = read_power_sums(from);
  sums.means.read_state(from);
  sums.pieces = read_piece_variances(from);
  return sums;
}

template <class Archive, class Count>
void spikes_layout(Archive& at, Count& n) {
  at(n.samples, n.left_out, n.spikes, n.shoulder, n.steps, n.crowded, n.log_size);
  for (auto* sums : {&n.with, &n.without}) at(sums->count, sums->all, sums->near, sums->far);
}

struct RecordStage {
  using Sums = RecordSums;
  void join(RecordSums& sums, RecordSums later) { detail::join(sums, std::move(later)); }
  void settle(RecordSums& sums, std::uint64_t height, std::uint64_t first_leaf) {
    detail::settle(sums, height, first_leaf);
  }
};

}  // namespace

MeanMeter means_of_leaf(std::span<const double> leaf) {
  MeanMeter means(kPerMean);
  means.push(leaf);
  return means;
}

FittedSums fitted_sums(std::span<const double> leaf, const LeafKind& kind, const BlockTransforms& blocks,
                       PowerPart* shared) {
  FittedSums sums;
  PowerPart own;
  if (shared == nullptr && !kind.whole) {
    const std::vector<double> filled = kind.bridged ? bridged(leaf) : std::vector<double>();
    own.push(filled.empty() ? leaf : filled);
  } else if (shared == nullptr) {
    blocks.take(leaf, own);
  }
  sums.bins = (shared != nullptr ? *shared : own).finish(kind.last);
  sums.allan = sums_of_pieces(leaf, sums.pieces);
  sums.means = means_of_leaf(leaf);
  return sums;
}

void join(RecordSums& sums, RecordSums later) {
  if (sums.cleaned || later.cleaned) {
    if (!sums.cleaned) sums.cleaned = sums.plain;
    join(*sums.cleaned, later.cleaned ? std::move(*later.cleaned) : later.plain);
  }
  join(sums.plain, std::move(later.plain));
  add_count(later.spikes, sums.spikes);
}

void settle(RecordSums& sums, std::uint64_t height, std::uint64_t first_leaf) {
  if (height != kSettledHeight) return;
  settle_means(sums.plain.bins, first_leaf * kLeafSamples);
  if (sums.cleaned) settle_means(sums.cleaned->bins, first_leaf * kLeafSamples);
}

void scale(RecordSums& sums, double factor) {
  scale_fitted(sums.plain, factor);
  if (sums.cleaned) scale_fitted(*sums.cleaned, factor);
}

RecordSums record_sums(std::span<const double> record, bool remedies) {
  const BlockTransforms blocks(PowerPart::kBlock);
  RecordStage stage;
  LeafTree<RecordStage> tree(stage);
  for (std::uint64_t leaf = 0; !record.empty(); ++leaf) {
    const std::span<const double> samples = record.first(std::min<std::size_t>(record.size(), kLeafSamples));
    record = record.subspan(samples.size());
    const std::size_t missing = count_missing(samples);
    LeafKind kind{record.empty(), remedies, missing == 0};
    RecordSums sums{fitted_sums(samples, kind, blocks), {}, {}};
    sums.spikes.samples = samples.size() - missing;
    kind.whole = false;
    if (remedies && kurtosis_of_differences(samples) > spike_alarm(sums.spikes.samples))
      sums.cleaned = fitted_sums(cleaned_record(samples, sums.spikes), kind, blocks);
    tree.add({0, leaf, std::move(sums)});
  }
  return tree.whole();
}

void write_state(const RecordSums& sums, StateWriter& to) {
  write_fitted(sums.plain, to);
  to.flag(sums.cleaned.has_value());
  if (sums.cleaned) write_fitted(*sums.cleaned, to);
  spikes_layout(to, sums.spikes);
}

RecordSums read_record_sums(StateReader& from) {
  RecordSums sums;
  sums.plain = read_fitted(from);
  if (from.flag()) sums.cleaned = read_fitted(from);
  spikes_layout(from, sums.spikes);
  return sums;
}

}  // namespace libchar::detail
