// Squared DCT-II coefficients of a record of any length, in two levels:
//   above f_split = 15.5/(2 block dt):  transforms of blocks of 2^15 samples, pooled, k >= 16, and of the tail
//   below f_split:                      the transform of the series of means of block/64 = 512 samples over a whole
//                                       segment
// Both use their exact expectations (dct_means). Sixteen coefficients of every block are left to the second level, so
// that neighbouring blocks stay uncorrelated under flicker and walk and the slow noise is seen with the full resolution
// of the segment; white noise is exactly uncorrelated within each level.
//
// A record comes in parts: the powers of blocks are added, and the series of means is put together
// from those of the parts, each less its own first sample x_0, once at the end:
//
//   sqrt(p) (mean_i - x_0) = sqrt(p) (mean_i - x_0part) + sqrt(p) (x_0part - x_0).
//
// A part of a clean record is a multiple of a block long. Where samples are missing the rest of it that fills no block
// is cut into pieces of 16384, 8192, 4096 and 2048 samples, whose transforms are pooled by their length; the rest of
// those (at most 2047 samples a part) and of a mean are left out. So is the rest in front of a gap of more than 4096
// samples. Whether such a gap ends a segment is decided at the end, when it is known how many samples are in front of
// it: a record begins anew where it is longer than one in hundred of them. Memory: 64 means a block, and a block of
// each length.
//
// Parts of 2^29 samples are settled: their means become powers of blocks of 2^15 means, as those of mean_series.hpp,
// and one value for 2^18 samples. Where samples are missing the rest is cut into pieces of 2^14 … 2^6 means, and a gap
// is measured against all that is in front of the part, present or missing.
//
// Events (steps, a warm-up, a ramp) are e_t with e known: the series of means loses its mean e, and
// the pooled powers of blocks lose sum e_k² of the transforms of e over the places of the blocks,
// with a cross term 2 n_k e_k left that has no mean (record_powers.cpp). Where samples are missing,
// places are those of a record whose missing ones are spread evenly over the run.
#include "libchar/fit/record/power_sums.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "libchar/core/numeric/present.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fit/detail/record/mean_series.hpp"
#include "libchar/fit/detail/record/record_powers.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar::detail {
namespace {

constexpr std::uint64_t kSamplesAMean = PowerPart::kBlock / kMeansPerBlock;
constexpr std::size_t kPieceLengths = std::tuple_size_v<decltype(PowerSums::pieces)>;

std::uint64_t piece_length(std::size_t piece) { return PowerPart::kBlock >> (piece + 1); }

/// What events do to a record, on its clock.
struct Shape {
  std::span<const Event> events;
  double rate_hz = 1;
  double mean(double first, double count) const { return event_mean(events, rate_hz, first, count); }
};

/// A segment: runs between which gaps are closed up.
struct Segment {
  std::uint64_t samples = 0, at = 0, rows = 0;
  double shift = 0;
  std::vector<double> means, slow;

  void add(const PowerRun& run, const Shape& shape) {
    if (samples == 0) {
      shift = run.shift;
      at = run.at;
    }
    samples += run.samples;
    rows = run.at + run.rows - at;
    add_series(run.means, kSamplesAMean, run, shape, means);
    add_series(run.slow, kSamplesAMean * kMeansPerSlow, run, shape, slow);
  }

 private:
  /// sqrt(p) (mean of p samples less `run.shift`), about the segment's shift and without the events.
  void add_series(std::span<const double> values, std::uint64_t p, const PowerRun& run, const Shape& shape,
                  std::vector<double>& to) const {
    const double root = std::sqrt(static_cast<double>(p)), moved = root * (run.shift - shift);
    const double stretch = static_cast<double>(run.rows) / static_cast<double>(run.samples);
    const double length = static_cast<double>(p) * stretch;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double first = static_cast<double>(run.at) + static_cast<double>(i) * length;
      const double event = shape.events.empty() ? 0 : root * shape.mean(first, length);
      to.push_back(values[i] + moved - event);
    }
  }
};

/// The series of means; `alone`: the tail is all of the segment, and has all there is.
void append_means(Segment segment, bool alone, std::vector<PooledPower>& out) {
  const std::vector<double>& means = segment.means;
  if (alone) return;
  if (!segment.slow.empty()) return append_slow(means, std::move(segment.slow), kSamplesAMean, PowerPart::kBlock, out);
  if (means.size() < kSmallestTransform) return;
  out.push_back(record_power(means, kSamplesAMean, 1, end_of_left(means.size(), kSamplesAMean, PowerPart::kBlock)));
}

/// Per transform, the energy of events over `count` blocks that follow each other: of `length`
/// means of `p` samples, whose places are `stretch` times as far apart as what is present.
std::vector<double> energy_of(const Shape& shape, std::uint64_t count, std::size_t length, double p, double stretch) {
  std::vector<double> energy(length, 0.0), values(length);
  Dct plan(length);
  const double block = static_cast<double>(length) * p * stretch;
  const bool drifts =
      std::any_of(shape.events.begin(), shape.events.end(), [](const Event& e) { return e.kind != EventKind::step; });
  const auto steps_in = [&](double first) {
    return std::any_of(shape.events.begin(), shape.events.end(), [&](const Event& e) {
      const double at = std::round(e.at_s * shape.rate_hz);
      return e.kind == EventKind::step && at > first && at < first + block;
    });
  };
  for (std::uint64_t b = 0; b < count; ++b) {
    const double first = static_cast<double>(b) * block;
    if (!drifts && !steps_in(first)) continue;
    for (std::size_t t = 0; t < length; ++t)
      values[t] = std::sqrt(p) * shape.mean(first + static_cast<double>(t) * p * stretch, p * stretch);
    const std::span<const double> c = plan.transform(values);
    for (std::size_t k = 0; k < length; ++k) energy[k] += c[k] * c[k];
  }
  for (double& e : energy) e /= static_cast<double>(std::max<std::uint64_t>(count, 1));
  return energy;
}

/// The energy of events in what was pooled of whole blocks.
void add_energy(const Shape& shape, double p, double stretch, PooledPower& power) {
  const std::vector<double> energy = energy_of(shape, power.pooled, detail::in_memory(power.length), p, stretch);
  for (std::size_t i = 0; i < power.mean.size(); ++i)
    power.of_events.push_back(energy[detail::in_memory(power.first) + i]);
}

/// Runs of one segment into one.
PowerRun settled(const Segment& segment, std::uint64_t gap, MeanCutter& cutter, MeanPowers& to) {
  const std::span<const double> means = segment.means;
  cutter.take_pieces(means.subspan(cutter.take_blocks(means, to)), to);
  return {gap, segment.samples, segment.shift, {}, slow_means(means), segment.at, segment.rows};
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
  void take_rows(std::uint64_t rows);
  void add_means(std::span<const double> values);
  void flush_block();
  void cut_rest();
  void end_run();
};

PowerPart::PowerPart() : state_(detail::hidden<State>()) {}

void PowerPart::State::push(std::span<const double> values) {
  while (!values.empty()) {
    if (std::isnan(values[0])) {
      ++gap;
      ++sums.rows;
      values = values.subspan(1);
      continue;
    }
    begin_run(values[0]);
    const std::size_t run_length =
        present_run(values.first(std::min<std::size_t>(values.size(), kBlock - pending.size())));
    pending.insert(pending.end(), values.begin(), values.begin() + static_cast<std::ptrdiff_t>(run_length));
    take_rows(run_length);
    values = values.subspan(run_length);
    if (pending.size() == kBlock) flush_block();
  }
}

/// What a present sample after missing ones, or the first of all, begins. The gap in front of the first run is told
/// even when it is short: with the one at the end of the part before it may be long.
void PowerPart::State::begin_run(double first) {
  if (gap > kLongGap && run.samples > 0) end_run();
  if (run.samples == 0) {
    run.gap = gap;
    run.shift = first;
    run.at = sums.rows;
  }
  gap = 0;
}

/// Of the run, all present.
void PowerPart::State::take_rows(std::uint64_t rows) {
  run.samples += rows;
  sums.rows += rows;
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
    const std::size_t length = detail::in_memory(piece_length(piece));
    if (rest.size() < length) continue;
    Dct transform(length);
    add_squares(transform.transform(rest.first(length)), sums.pieces[piece]);
    rest = rest.subspan(length);
  }
  pending.clear();
}

void PowerPart::State::end_run() {
  cut_rest();
  run.rows = sums.rows - gap - run.at;
  sums.runs.push_back(std::exchange(run, {}));
}

void PowerPart::push(std::span<const double> samples) { state_->push(samples); }

bool PowerPart::take_block(std::span<const double> samples) {
  if (samples.size() != kBlock || (!state_->pending.empty() && state_->gap <= kLongGap)) return false;
  state_->begin_run(samples[0]);
  state_->take_rows(kBlock);
  state_->add_means(samples);
  ++state_->sums.blocks.transforms;
  return true;
}

void PowerPart::take_power(std::vector<double> power) { join(state_->sums.blocks, {0, std::move(power)}); }

PowerSums PowerPart::finish(bool last) {
  State& s = *state_;
  if (last) {
    s.add_means(s.pending);
    s.sums.tail = std::exchange(s.pending, {});
  }
  if (s.run.samples > 0) s.end_run();
  if (s.gap > 0) s.sums.runs.push_back({s.gap, 0, 0, {}, {}, s.sums.rows, 0});
  return std::move(s.sums);
}

void join(PowerSums& sums, PowerSums later) {
  join(sums.blocks, later.blocks);
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece) join(sums.pieces[piece], later.pieces[piece]);
  join(sums.means, later.means);
  if (!sums.runs.empty() && sums.runs.back().samples == 0 && !later.runs.empty()) {
    later.runs.front().gap += sums.runs.back().gap;
    sums.runs.pop_back();
  }
  for (PowerRun& run : later.runs) run.at += sums.rows;
  sums.rows += later.rows;
  sums.runs.insert(sums.runs.end(), std::make_move_iterator(later.runs.begin()),
                   std::make_move_iterator(later.runs.end()));
  if (!later.tail.empty()) sums.tail = std::move(later.tail);
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
    segment.add(std::exchange(run, {}), {});
  }
  end_segment();
  sums.runs = std::move(runs);
}

void scale(PowerSums& sums, double factor) {
  const auto times = [](std::vector<double>& values, double by) {
    for (double& value : values) value *= by;
  };
  times(sums.blocks.power, factor * factor);
  times(sums.means.blocks.power, factor * factor);
  for (PooledSums& piece : sums.pieces) times(piece.power, factor * factor);
  for (PooledSums& piece : sums.means.pieces) times(piece.power, factor * factor);
  for (PowerRun& run : sums.runs) {
    run.shift *= factor;
    times(run.means, factor);
    times(run.slow, factor);
  }
  times(sums.tail, factor);
}

std::vector<PooledPower> powers_of(PowerSums sums, std::span<const Event> events, double rate_hz) {
  const Shape shape{events, rate_hz};
  std::vector<PooledPower> powers;
  std::uint64_t samples = 0;
  Segment segment;
  for (PowerRun& run : sums.runs) {
    if (run.samples == 0) continue;
    if (segment.samples > 0 && run.gap > std::max(kLongGap, samples / 100))
      append_means(std::exchange(segment, {}), false, powers);
    samples += run.samples;
    segment.add(std::exchange(run, {}), shape);
  }
  const double stretch = samples > 0 ? static_cast<double>(sums.rows) / static_cast<double>(samples) : 1;
  const std::uint64_t tail = sums.tail.size();
  const bool alone = tail == segment.samples;
  if (!events.empty())
    for (std::size_t t = 0; t < tail; ++t)
      sums.tail[t] -= shape.mean(static_cast<double>(sums.rows) - static_cast<double>(tail - t) * stretch, stretch);
  if (tail >= kSmallestTransform)
    powers.push_back(record_power(sums.tail, 1, alone ? 1 : first_kept(tail, PowerPart::kBlock), tail));
  append_means(std::move(segment), alone, powers);
  const std::size_t before_blocks = powers.size();
  append_powers(sums.means, kSamplesAMean, powers);
  const auto append = [&](const PooledSums& pooled, std::uint64_t length) {
    append_pooled(pooled, length, 1, first_kept(length, PowerPart::kBlock), powers);
  };
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece) append(sums.pieces[piece], piece_length(piece));
  append(sums.blocks, PowerPart::kBlock);
  if (!events.empty())
    for (std::size_t i = before_blocks; i < powers.size(); ++i)
      if (powers[i].length == PowerPart::kBlock)
        add_energy(shape, static_cast<double>(powers[i].spacing), stretch, powers[i]);
  return powers;
}

template <class Archive, class Runs>
static void runs_layout(Archive& at, Runs& runs) {
  at.list(runs, 56, [&](auto& run) { at(run.gap, run.samples, run.shift, run.means, run.slow, run.at, run.rows); });
}

void write_state(const PowerSums& sums, StateWriter& to) {
  to.number(sums.rows);
  write_state(sums.blocks, to);
  for (const PooledSums& piece : sums.pieces) write_state(piece, to);
  write_state(sums.means, to);
  runs_layout(to, sums.runs);
  to.reals(sums.tail);
}

PowerSums read_power_sums(StateReader& from) {
  PowerSums sums;
  sums.rows = from.number();
  sums.blocks = read_pooled_sums(PowerPart::kBlock, from);
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece)
    sums.pieces[piece] = read_pooled_sums(piece_length(piece), from);
  sums.means = read_mean_powers(kSamplesAMean, PowerPart::kBlock, from);
  runs_layout(from, sums.runs);
  for (const PowerRun& run : sums.runs) {
    if (run.rows < run.samples || run.at > sums.rows || run.rows > sums.rows - run.at)
      from.refuse("the place of a run");
    if (run.means.size() + run.slow.size() * kMeansPerSlow > run.samples / kSamplesAMean)
      from.refuse("the means of a run");
  }
  sums.tail = from.reals();
  if (sums.tail.size() >= PowerPart::kBlock) from.refuse("its tail");
  return sums;
}

}  // namespace libchar::detail
