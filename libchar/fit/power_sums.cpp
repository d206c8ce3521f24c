// The two levels of power_bins.cpp, of a record that comes in parts: the powers of blocks are added, and the series of means is put
// together from those of the parts, each less its own first sample x_0, once at the end:
//
//   sqrt(p) (mean_i - x_0) = sqrt(p) (mean_i - x_0part) + sqrt(p) (x_0part - x_0).
//
// A part of a clean record is a multiple of a block long. Where samples are missing the rest of it that fills no block is cut into
// pieces of 16384, 8192, 4096 and 2048 samples, whose transforms are pooled by their length; the rest of those (at most 2047 samples
// a part) and of a mean are left out. So is the rest in front of a gap of more than 4096 samples. Whether such a gap ends a segment
// is decided at the end, when it is known how many samples are in front of it: a record begins anew where it is longer than one in
// hundred of them, as in power_bins.cpp. Memory: 64 means a block, and a block of each length.
//
// Of a record of more than 2^29 samples, parts of 2^24 samples are settled: their means become powers of a block of 2^15 means, as those
// of mean_series.hpp, and one value for 2^18 samples. Where samples are missing the rest is cut into pieces of 2^14 … 2^6 means, and a gap
// is measured against all that is in front of the part, present or missing.
#include "libchar/fit/power_sums.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "libchar/core/present.hpp"
#include "libchar/fit/detail/mean_series.hpp"
#include "libchar/fit/detail/record_powers.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kSamplesAMean = PowerPart::kBlock / kMeansPerBlock;
constexpr std::size_t kPieceLengths = std::tuple_size_v<decltype(PowerSums::pieces)>;

std::uint64_t piece_length(std::size_t piece) {
  return PowerPart::kBlock >> (piece + 1);
}

/// A segment: runs between which gaps are closed up.
struct Segment {
  std::uint64_t samples = 0;
  double shift = 0;
  std::vector<double> means, slow;

  void add(const PowerRun& run) {
    if (samples == 0) shift = run.shift;
    samples += run.samples;
    const double moved = std::sqrt(static_cast<double>(kSamplesAMean)) * (run.shift - shift);
    for (const double mean : run.means) means.push_back(mean + moved);
    const double slow_moved = std::sqrt(static_cast<double>(kMeansPerSlow)) * moved;
    for (const double mean : run.slow) slow.push_back(mean + slow_moved);
  }
};

/// The series of means; `alone`: the tail is all of the segment, and has all there is.
void append_means(Segment segment, bool alone, std::vector<PooledPower>& out) {
  const std::vector<double>& means = segment.means;
  if (alone) return;
  if (!segment.slow.empty())
    return append_slow(means, std::move(segment.slow), kSamplesAMean, PowerPart::kBlock, out);
  if (means.size() < kSmallestTransform) return;
  out.push_back(record_power(
      means, kSamplesAMean, 1, end_of_left(means.size(), kSamplesAMean, PowerPart::kBlock)));
}

/// Runs of one segment into one.
PowerRun settled(const Segment& segment, std::uint64_t gap, MeanCutter& cutter, MeanPowers& to) {
  const std::span<const double> means = segment.means;
  cutter.take_pieces(means.subspan(cutter.take_blocks(means, to)), to);
  return {gap, segment.samples, segment.shift, {}, slow_means(means)};
}

}  // namespace

struct PowerPart::State {
  PowerSums sums;
  std::optional<Dct> plan;
  std::vector<double> pending;  ///< samples of the block that is being filled
  PowerRun run;
  std::uint64_t gap = 0;

  void push(std::span<const double> values);
  void begin_run(double first);
  void add_means(std::span<const double> values);
  void flush_block();
  void cut_rest();
  void end_run();
};

PowerPart::PowerPart() : state_(std::make_unique<State>()) {}
PowerPart::~PowerPart() = default;

void PowerPart::State::push(std::span<const double> values) {
  while (!values.empty()) {
    if (std::isnan(values[0])) {
      ++gap;
      values = values.subspan(1);
      continue;
    }
    begin_run(values[0]);
    const std::size_t run_length =
        present_run(values.first(std::min<std::size_t>(values.size(), kBlock - pending.size())));
    pending.insert(
        pending.end(), values.begin(), values.begin() + static_cast<std::ptrdiff_t>(run_length));
    run.samples += run_length;
    values = values.subspan(run_length);
    if (pending.size() == kBlock) flush_block();
  }
}

/// What a present sample after missing ones, or the first of all, begins. The gap in front of the first run is told even when it is
/// short: with the one at the end of the part before it may be long.
void PowerPart::State::begin_run(double first) {
  if (gap > kLongGap && run.samples > 0) end_run();
  if (run.samples == 0) {
    run.gap = gap;
    run.shift = first;
  }
  gap = 0;
}

/// Of as many as make whole means.
void PowerPart::State::add_means(std::span<const double> values) {
  for (; values.size() >= kSamplesAMean; values = values.subspan(kSamplesAMean)) {
    double sums_of_eight[8] = {};
    for (std::size_t i = 0; i < kSamplesAMean; ++i) sums_of_eight[i % 8] += values[i] - run.shift;
    const double* s = sums_of_eight;
    const double sum = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
    run.means.push_back(sum / std::sqrt(static_cast<double>(kSamplesAMean)));
  }
}

void PowerPart::State::flush_block() {
  if (!plan) plan.emplace(kBlock);
  add_means(pending);
  add_squares(plan->transform(pending), sums.blocks);
  pending.clear();
}

/// The rest that fills no block.
void PowerPart::State::cut_rest() {
  add_means(pending);
  std::span<const double> rest = pending;
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece) {
    const std::uint64_t length = piece_length(piece);
    if (rest.size() < length) continue;
    Dct transform(length);
    add_squares(transform.transform(rest.first(length)), sums.pieces[piece]);
    rest = rest.subspan(length);
  }
  pending.clear();
}

void PowerPart::State::end_run() {
  cut_rest();
  sums.runs.push_back(std::exchange(run, {}));
}

void PowerPart::push(std::span<const double> samples) {
  state_->push(samples);
}

bool PowerPart::take_block(std::span<const double> samples) {
  if (samples.size() != kBlock || (!state_->pending.empty() && state_->gap <= kLongGap))
    return false;
  state_->begin_run(samples[0]);
  state_->run.samples += kBlock;
  state_->add_means(samples);
  ++state_->sums.blocks.transforms;
  return true;
}

void PowerPart::take_power(std::vector<double> power) {
  libchar::join(state_->sums.blocks, {0, std::move(power)});
}

PowerSums PowerPart::finish(bool last) {
  State& s = *state_;
  if (last) {
    s.add_means(s.pending);
    s.sums.tail = std::exchange(s.pending, {});
  }
  if (s.run.samples > 0) s.end_run();
  if (s.gap > 0) s.sums.runs.push_back({s.gap, 0, 0, {}, {}});
  return std::move(s.sums);
}

void join(PowerSums& sums, PowerSums later) {
  join(sums.blocks, later.blocks);
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece)
    join(sums.pieces[piece], later.pieces[piece]);
  join(sums.means, later.means);
  if (!sums.runs.empty() && sums.runs.back().samples == 0 && !later.runs.empty()) {
    later.runs.front().gap += sums.runs.back().gap;
    sums.runs.pop_back();
  }
  sums.runs.insert(sums.runs.end(),
                   std::make_move_iterator(later.runs.begin()),
                   std::make_move_iterator(later.runs.end()));
  if (!later.tail.empty()) sums.tail = std::move(later.tail);
}

bool is_long_record(std::uint64_t samples) {
  return samples / kSamplesAMean > kMostMeans;
}

void settle_means(PowerSums& sums, std::uint64_t samples_before) {
  MeanCutter cutter(kSamplesAMean, PowerPart::kBlock);
  std::vector<PowerRun> runs;
  Segment segment;
  std::uint64_t gap = 0;
  const auto end_segment = [&] {
    if (segment.samples > 0) runs.push_back(settled(segment, gap, cutter, sums.means));
    segment = {};
  };
  for (PowerRun& run : sums.runs) {
    if (run.samples == 0 || run.gap > std::max(kLongGap, samples_before / 100)) end_segment();
    if (run.samples == 0) {
      runs.push_back(std::move(run));
      continue;
    }
    if (segment.samples == 0) gap = run.gap;
    segment.add(std::exchange(run, {}));
  }
  end_segment();
  sums.runs = std::move(runs);
}

PowerBinner binner_of(PowerSums sums) {
  std::vector<PooledPower> powers;
  std::uint64_t samples = 0;
  Segment segment;
  for (PowerRun& run : sums.runs) {
    if (run.samples == 0) continue;
    if (segment.samples > 0 && run.gap > std::max(kLongGap, samples / 100))
      append_means(std::exchange(segment, {}), false, powers);
    samples += run.samples;
    segment.add(std::exchange(run, {}));
  }
  const std::uint64_t tail = sums.tail.size();
  const bool alone = tail == segment.samples;
  if (tail >= kSmallestTransform)
    powers.push_back(
        record_power(sums.tail, 1, alone ? 1 : first_kept(tail, PowerPart::kBlock), tail));
  append_means(std::move(segment), alone, powers);
  append_powers(sums.means, kSamplesAMean, powers);
  const auto append = [&](const PooledSums& pooled, std::uint64_t length) {
    append_pooled(pooled, length, 1, first_kept(length, PowerPart::kBlock), powers);
  };
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece)
    append(sums.pieces[piece], piece_length(piece));
  append(sums.blocks, PowerPart::kBlock);
  return PowerBinner(std::move(powers));
}

void write_state(const PowerSums& sums, StateWriter& to) {
  write_state(sums.blocks, to);
  for (const PooledSums& piece : sums.pieces) write_state(piece, to);
  write_state(sums.means, to);
  to.number(sums.runs.size());
  for (const PowerRun& run : sums.runs) {
    to.number(run.gap);
    to.number(run.samples);
    to.real(run.shift);
    to.reals(run.means);
    to.reals(run.slow);
  }
  to.reals(sums.tail);
}

PowerSums read_power_sums(StateReader& from) {
  PowerSums sums;
  sums.blocks = read_pooled_sums(PowerPart::kBlock, from);
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece)
    sums.pieces[piece] = read_pooled_sums(piece_length(piece), from);
  sums.means = read_mean_powers(kSamplesAMean, PowerPart::kBlock, from);
  sums.runs.resize(from.count(40));
  for (PowerRun& run : sums.runs) {
    run.gap = from.number();
    run.samples = from.number();
    run.shift = from.real();
    run.means = from.reals();
    run.slow = from.reals();
    if (run.means.size() + run.slow.size() * kMeansPerSlow > run.samples / kSamplesAMean)
      from.refuse("the means of a run");
  }
  sums.tail = from.reals();
  if (sums.tail.size() >= PowerPart::kBlock) from.refuse("its tail");
  return sums;
}

}  // namespace libchar
