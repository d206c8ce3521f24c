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
#include "libchar/fit/power_sums.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "libchar/core/free_memory.hpp"
#include "libchar/core/present.hpp"
#include "libchar/fit/detail/pooled_power.hpp"
#include "libchar/fit/detail/record_powers.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kSamplesAMean = PowerPart::kBlock / kMeansPerBlock;
constexpr std::size_t kPieceLengths = std::tuple_size_v<decltype(PowerSums::pieces)>;

std::uint64_t piece_length(std::size_t piece) {
  return PowerPart::kBlock >> (piece + 1);
}

/// The first coefficient that is not left to the series of means.
std::uint64_t first_kept(std::uint64_t length) {
  const double split = (static_cast<double>(kLeftToMeans) - 0.5) / PowerPart::kBlock;
  return std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::ceil(split * static_cast<double>(length))));
}

void add_squares(std::span<const double> c, PooledSums& sums) {
  sums.power.resize(c.size());
  for (std::size_t k = 1; k < c.size(); ++k) sums.power[k] += c[k] * c[k];
  ++sums.transforms;
}

void add(const PooledSums& later, PooledSums& sums) {
  if (sums.power.empty()) sums.power.resize(later.power.size());
  for (std::size_t k = 0; k < later.power.size(); ++k) sums.power[k] += later.power[k];
  sums.transforms += later.transforms;
}

void add_powers(const PooledSums& sums, std::uint64_t length, std::vector<PooledPower>& out) {
  if (sums.transforms == 0) return;
  PooledPower pooled{length, 1, first_kept(length), sums.transforms, {}};
  for (std::uint64_t k = pooled.first; k < length; ++k)
    pooled.mean.push_back(sums.power[k] / static_cast<double>(sums.transforms));
  out.push_back(std::move(pooled));
}

/// A segment: runs between which gaps are closed up.
struct Segment {
  std::uint64_t samples = 0;
  double shift = 0;
  std::vector<double> means;

  void add(const PowerRun& run) {
    if (samples == 0) shift = run.shift;
    samples += run.samples;
    const double moved = std::sqrt(static_cast<double>(kSamplesAMean)) * (run.shift - shift);
    for (const double mean : run.means) means.push_back(mean + moved);
  }
};

/// The series of means; `alone`: the tail is all of the segment, and has all there is.
void add_means(const Segment& segment, bool alone, std::vector<PooledPower>& out) {
  if (alone || segment.means.size() < kSmallestTransform) return;
  const double split = (static_cast<double>(kLeftToMeans) - 0.5) / PowerPart::kBlock;
  const auto low =
      static_cast<std::uint64_t>(split * static_cast<double>(segment.means.size() * kSamplesAMean));
  const std::uint64_t end = std::min<std::uint64_t>(low + 1, segment.means.size());
  out.push_back(record_power(segment.means, kSamplesAMean, 1, end));
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
  add({0, std::move(power)}, state_->sums.blocks);
}

PowerSums PowerPart::finish(bool last) {
  State& s = *state_;
  if (last) {
    s.add_means(s.pending);
    s.sums.tail = std::exchange(s.pending, {});
  }
  if (s.run.samples > 0) s.end_run();
  if (s.gap > 0) s.sums.runs.push_back({s.gap, 0, 0, {}});
  return std::move(s.sums);
}

void join(PowerSums& sums, PowerSums later) {
  add(later.blocks, sums.blocks);
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece)
    add(later.pieces[piece], sums.pieces[piece]);
  if (!sums.runs.empty() && sums.runs.back().samples == 0 && !later.runs.empty()) {
    later.runs.front().gap += sums.runs.back().gap;
    sums.runs.pop_back();
  }
  sums.runs.insert(sums.runs.end(),
                   std::make_move_iterator(later.runs.begin()),
                   std::make_move_iterator(later.runs.end()));
  if (!later.tail.empty()) sums.tail = std::move(later.tail);
}

PowerBinner binner_of(PowerSums sums) {
  std::vector<PooledPower> powers;
  std::uint64_t samples = 0;
  Segment segment;
  std::size_t left = 0;
  for (const PowerRun& run : sums.runs) left += run.means.size();
  for (PowerRun& run : sums.runs) {
    if (run.samples == 0) continue;
    if (segment.samples > 0 && run.gap > std::max(kLongGap, samples / 100)) {
      add_means(segment, false, powers);
      segment = {};
    }
    if (segment.samples == 0) segment.means.reserve(left);
    left -= run.means.size();
    samples += run.samples;
    segment.add(std::exchange(run, {}));
  }
  const std::uint64_t tail = sums.tail.size();
  const bool alone = tail == segment.samples;
  if (tail >= kSmallestTransform)
    powers.push_back(record_power(sums.tail, 1, alone ? 1 : first_kept(tail), tail));
  add_means(segment, alone, powers);
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece)
    add_powers(sums.pieces[piece], piece_length(piece), powers);
  add_powers(sums.blocks, PowerPart::kBlock, powers);
  return PowerBinner(std::move(powers));
}

void write_state(PowerSums sums, StateWriter& to) {
  const auto write = [&](const PooledSums& pooled) {
    to.number(pooled.transforms);
    to.reals(pooled.power);
  };
  write(sums.blocks);
  for (const PooledSums& piece : sums.pieces) write(piece);
  to.number(sums.runs.size());
  constexpr std::size_t kGiveBackEvery = 256;  // runs of 16 KB, mostly
  for (std::size_t i = 0; i < sums.runs.size(); ++i) {
    const PowerRun run = std::exchange(sums.runs[i], {});
    to.number(run.gap);
    to.number(run.samples);
    to.real(run.shift);
    to.reals(run.means);
    if ((i + 1) % kGiveBackEvery == 0) give_back_free_memory();
  }
  to.reals(sums.tail);
}

PowerSums read_power_sums(StateReader& from) {
  const auto read = [&](std::uint64_t length) {
    PooledSums pooled;
    pooled.transforms = from.number();
    pooled.power = from.reals();
    if (pooled.power.size() != length && (!pooled.power.empty() || pooled.transforms > 0))
      from.refuse("the powers of its transforms");
    return pooled;
  };
  PowerSums sums;
  sums.blocks = read(PowerPart::kBlock);
  for (std::size_t piece = 0; piece < kPieceLengths; ++piece)
    sums.pieces[piece] = read(piece_length(piece));
  sums.runs.resize(from.count(32));
  for (PowerRun& run : sums.runs) {
    run.gap = from.number();
    run.samples = from.number();
    run.shift = from.real();
    run.means = from.reals();
    if (run.means.size() > run.samples / kSamplesAMean) from.refuse("the means of a run");
  }
  sums.tail = from.reals();
  if (sums.tail.size() >= PowerPart::kBlock) from.refuse("its tail");
  return sums;
}

}  // namespace libchar
