// Welch's method on samples as they come. By pairs of halves, where that is possible: each is
// transformed once. Else one segment is kept, its tail is the head of the next.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/spectrum/detail/half_segments.hpp"
#include "libchar/spectrum/detail/segments.hpp"
#include "libchar/spectrum/welch_sums.hpp"

namespace libchar {

using namespace welch_detail;

struct WelchStream::State {
  WelchOptions options;
  Layout layout;
  std::vector<double> window;              // none: by halves
  std::optional<Periodogram> periodogram;  // one of the two
  std::optional<HalfSegments> halves;
  Average average;
  std::vector<double> segment;  // its first `filled` samples are there (or those of two halves)
  std::size_t filled = 0;
  std::vector<double> group;                  // power of the group under way, `in_group` segments of it
  HalfSegments::SumsPointer sums, next_sums;  // the same by halves; of the group after it
  std::size_t in_group = 0;
  std::uint64_t samples = 0;
  bool first_pair = true;

  State(const WelchOptions& chosen, WelchWorkspace* workspace)
      : options(chosen),
        layout(layout_of(chosen.segment, chosen.overlap)),
        window(HalfSegments::suits(chosen) ? std::vector<double>() : window_values(chosen.window, layout.segment)),
        average(options, layout),
        group(layout.segment / 2 + 1, 0.0) {
    if (window.empty()) {
      halves.emplace(layout.segment, workspace != nullptr ? &workspace->state().pools : nullptr);
      sums = halves->zero_sums();
      next_sums = halves->zero_sums();
    } else {
      periodogram.emplace(options, window);
    }
    segment.resize(layout.segment);
  }
  void take(const double* x);
  HalfSegments::Half half_at(const double* x, SharedBlocks* blocks) const;
  void take_pair(const double* x, SharedBlocks* blocks);
  void push_by_segments(std::span<const double> pushed);
  void push_by_halves(std::span<const double> pushed, SharedBlocks* blocks);
  void take_last_half(SharedBlocks& blocks);
  void add_rest(Average& whole) const;
  void check_shared(const SharedBlocks& blocks) const;
};

void WelchStream::State::take(const double* x) {
  average.note_segment(periodogram->add(x, group.data()));
  if (++in_group < layout.group) return;
  average.add_group(group);
  std::fill(group.begin(), group.end(), 0.0);
  in_group = 0;
}

HalfSegments::Half WelchStream::State::half_at(const double* x, SharedBlocks* blocks) const {
  HalfSegments::Half half = halves->half_at(x);
  half.block = blocks != nullptr && blocks->offer({x, layout.hop}, std::isfinite(half.mean));
  return half;
}

// The first pair ends one segment, every other two; groups are of an even number of segments, so
// that they end with the first of the two.
void WelchStream::State::take_pair(const double* x, SharedBlocks* blocks) {
  const HalfSegments::Half a = half_at(x, blocks), b = half_at(x + layout.hop, blocks);
  const bool closes = in_group + 1 == layout.group;
  const auto used = halves->push(a, b, sums.get(), closes ? next_sums.get() : sums.get());
  if (!std::exchange(first_pair, false)) {
    average.note_segment(used.first);
    ++in_group;
  }
  if (closes) {
    halves->take_power(*sums, group);
    average.add_group(group);
    std::swap(sums, next_sums);
    in_group = 0;
  }
  average.note_segment(used.second);
  ++in_group;
}

void WelchStream::State::push_by_segments(std::span<const double> pushed) {
  const std::size_t n = layout.segment, hop = layout.hop;
  while (!pushed.empty()) {
    // Whole segments inside the pushed block need no copy.
    if (filled == 0)
      while (pushed.size() >= n) {
        take(pushed.data());
        pushed = pushed.subspan(hop);
      }
    const std::size_t more = std::min(n - filled, pushed.size());
    if (more > 0) std::memcpy(segment.data() + filled, pushed.data(), more * sizeof(double));
    filled += more;
    pushed = pushed.subspan(more);
    if (filled < n) return;
    take(segment.data());
    std::memmove(segment.data(), segment.data() + hop, (n - hop) * sizeof(double));
    filled = n - hop;
  }
}

void WelchStream::State::push_by_halves(std::span<const double> pushed, SharedBlocks* blocks) {
  const std::size_t pair = 2 * layout.hop;
  while (!pushed.empty()) {
    if (filled == 0 && pushed.size() >= pair) {  // where it lies
      take_pair(pushed.data(), blocks);
      pushed = pushed.subspan(pair);
      continue;
    }
    const std::size_t more = std::min(pair - filled, pushed.size());
    std::memcpy(segment.data() + filled, pushed.data(), more * sizeof(double));
    filled += more;
    pushed = pushed.subspan(more);
    if (filled < pair) return;
    take_pair(segment.data(), blocks);
    filled = 0;
  }
}

// Without a partner: the segment that it ends is in the sums, and nothing after it.
void WelchStream::State::take_last_half(SharedBlocks& blocks) {
  const std::size_t hop = layout.hop;
  const auto used = halves->push(half_at(segment.data(), &blocks), {}, sums.get(), nullptr);
  if (!std::exchange(first_pair, false)) {
    average.note_segment(used.first);
    ++in_group;
  }
  filled -= hop;
  std::memmove(segment.data(), segment.data() + hop, filled * sizeof(double));
}

void WelchStream::State::check_shared(const SharedBlocks& blocks) const {
  if (halves && blocks.length() == layout.hop) return;
  throw usage_error("E0201")
      .says("a spectrum with segments of {} samples cannot share blocks", layout.segment)
      .got(std::to_string(blocks.length()))
      .hint(halves ? fmt::format("share blocks of {} samples", layout.hop) : "");
}

// The group under way, and the segment of a half that still waits for its partner. Nothing here
// changes: more samples may come.
void WelchStream::State::add_rest(Average& whole) const {
  if (!halves) {
    if (in_group > 0) whole.add_group(group);
    return;
  }
  const auto rest = halves->copy_of(*sums);
  bool any = in_group > 0;
  if (filled >= layout.hop && !first_pair) {
    whole.note_segment(halves->add_last(halves->half_at(segment.data()), *rest));
    any = true;
  }
  if (!any) return;
  std::vector<double> power;
  halves->take_power(*rest, power);
  whole.add_group(power);
}

WelchStream::WelchStream(const WelchOptions& options, WelchWorkspace* workspace) {
  check_options(options);
  if (options.segment == 0)
    throw usage_error("E0205")
        .says("a streamed spectrum needs the length of its segments beforehand")
        .hint("give a segment length");
  state_ = detail::hidden<State>(options, workspace);
}
WelchStream::WelchStream(const WelchOptions& options, const WelchSums& sums, WelchWorkspace* workspace)
    : WelchStream(options, workspace) {
  state_->average = Average(state_->options, state_->layout, sums);
  state_->samples = sums.samples;
}

void WelchStream::push(std::span<const double> samples) {
  state_->samples += samples.size();
  state_->average.note_samples(samples);
  state_->halves ? state_->push_by_halves(samples, nullptr) : state_->push_by_segments(samples);
}

std::uint64_t WelchStream::shared_length() const { return state_->halves ? state_->layout.hop : 0; }

void WelchStream::push(std::span<const double> samples, SharedBlocks& blocks) {
  state_->check_shared(blocks);
  state_->samples += samples.size();
  state_->average.note_samples(samples);
  state_->push_by_halves(samples, &blocks);
}

void WelchStream::end(SharedBlocks& blocks) {
  state_->check_shared(blocks);
  if (state_->filled >= state_->layout.hop) state_->take_last_half(blocks);
  blocks.close(std::span<const double>(state_->segment).first(state_->filled), state_->halves->block_power());
}

WelchSums WelchStream::sums() const {
  Average whole = state_->average;
  state_->add_rest(whole);
  WelchSums out = whole.sums();
  out.samples = state_->samples;
  return out;
}

Spectrum WelchStream::finish(double rate_hz) const {
  check_rate(rate_hz);
  const State& s = *state_;
  Average whole = s.average;
  s.add_rest(whole);
  return whole.finish(s.window, rate_hz, s.samples);
}

}  // namespace libchar
