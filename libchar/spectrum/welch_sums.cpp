// Segments of n samples start at 0, D, 2D, … (detail/segments.cpp). Parts A and B of a record, A a multiple of D long:
// the segments of both are those within A, those within B, and those that start in A and end in B,
//
//   x[a - n + D .. ), x[a - n + 2 D .. ), …, x[a - D .. )        a samples in A,
//
// which stand in the last n - D samples of A and the first n - D of B. Sums of powers, and counts
// of pairs of segments by their distance, are added.

#include "libchar/spectrum/welch_sums.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/spectrum/detail/half_segments.hpp"
#include "libchar/spectrum/detail/segments.hpp"

namespace libchar {

using namespace welch_detail;

struct WelchParts::State {
  WelchOptions options;
  WelchWorkspace* workspace = nullptr;
  Layout layout;
  std::vector<double> window;
  std::optional<Periodogram> periodogram;
  std::uint64_t shared = 0;

  State(const WelchOptions& chosen, WelchWorkspace* shared_workspace)
      : options(chosen),
        workspace(shared_workspace),
        layout(layout_of(chosen.segment, chosen.overlap)),
        window(window_values(chosen.window, layout.segment)),
        shared(WelchStream(chosen, shared_workspace).shared_length()) {
    periodogram.emplace(options, window);
  }
  std::size_t end_samples() const { return layout.segment - layout.hop; }
};

WelchParts::WelchParts(const WelchOptions& options, WelchWorkspace* workspace)
    : state_(detail::hidden<State>(options, workspace)) {}

std::string WelchParts::why_not(const WelchOptions& options, std::uint64_t part) {
  check_options(options);
  const Layout layout = layout_of(options.segment, options.overlap);
  if (layout.segment > part)
    return fmt::format("segments of {} samples are longer than a leaf of {}", layout.segment, part);
  if (part % layout.hop != 0)
    return fmt::format("segments begin every {} samples, which do not divide a leaf of {}", layout.hop, part);
  return "";
}

std::uint64_t WelchParts::shared_length() const { return state_->shared; }

WelchSums WelchParts::take(std::span<const double> part, BlockTaker* taker) const {
  WelchStream stream(state_->options, state_->workspace);
  if (taker != nullptr && state_->shared != 0) {
    SharedBlocks blocks(state_->shared, *taker);
    stream.push(part, blocks);
    stream.end(blocks);
  } else {
    stream.push(part);
    if (taker != nullptr) taker->push(part);
  }
  WelchSums sums = stream.sums();
  const std::size_t ends = std::min(part.size(), state_->end_samples());
  sums.head.assign(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(ends));
  sums.tail.assign(part.end() - static_cast<std::ptrdiff_t>(ends), part.end());
  return sums;
}

void WelchParts::join(WelchSums& sums, const WelchSums& later) {
  if (later.samples == 0) return;
  if (sums.samples == 0) {
    sums = later;
    return;
  }
  State& s = *state_;
  const std::size_t n = s.layout.segment;
  std::vector<double> joint = sums.tail;
  joint.insert(joint.end(), later.head.begin(), later.head.end());
  std::vector<double> power(n / 2 + 1, 0.0);
  std::vector<char> straddling;
  for (std::size_t at = 0; at < sums.tail.size() && at + n <= joint.size(); at += s.layout.hop)
    straddling.push_back(s.periodogram->add(joint.data() + at, power.data()) ? 1 : 0);
  if (std::find(straddling.begin(), straddling.end(), 1) == straddling.end()) power.clear();
  Average whole(s.options, s.layout, sums);
  whole.join(power, straddling, later);
  WelchSums both = whole.sums();
  both.samples = sums.samples + later.samples;
  both.head = std::move(sums.head);
  // What follows a part shorter than this needs its predecessor's samples too.
  std::vector<double>& tail = both.tail;
  tail = later.tail;
  if (tail.size() < s.end_samples()) {
    const std::size_t more = std::min(s.end_samples() - tail.size(), sums.tail.size());
    tail.insert(tail.begin(), sums.tail.end() - static_cast<std::ptrdiff_t>(more), sums.tail.end());
  }
  sums = std::move(both);
}

template <class Archive, class Sums>
static void welch_layout(Archive& at, Sums& sums) {
  at(sums.samples, sums.used, sums.dropped, sums.power, sums.pairs, sums.begin, sums.end);
  at(sums.head, sums.tail, sums.first, sums.moves, sums.moves_little);
}

void WelchParts::write_state(const WelchSums& sums, StateWriter& to) { welch_layout(to, sums); }

WelchSums WelchParts::read_state(StateReader& from) const {
  WelchSums sums;
  welch_layout(from, sums);
  const Layout& layout = state_->layout;
  const std::size_t lags = (layout.segment - 1) / layout.hop;
  const bool none = sums.samples == 0 && sums.used == 0 && sums.dropped == 0 && sums.power.empty() &&
                    sums.pairs.empty() && sums.begin.empty() && sums.end.empty() && sums.head.empty() &&
                    sums.tail.empty();
  if (none) return sums;
  const std::uint64_t segments = layout.count(sums.samples);
  const std::size_t ends = std::min(detail::in_memory(sums.samples), state_->end_samples());
  const bool whole = (sums.used == 0 || !sums.power.empty()) &&
                     (sums.power.empty() || sums.power.size() == layout.segment / 2 + 1) && sums.used <= segments &&
                     sums.dropped == segments - sums.used && sums.pairs.size() == lags + 1 &&
                     *std::max_element(sums.pairs.begin(), sums.pairs.end()) <= segments &&
                     sums.begin.size() == std::min<std::uint64_t>(segments, lags) &&
                     sums.end.size() == sums.begin.size() && sums.head.size() == ends && sums.tail.size() == ends;
  if (!whole) from.refuse("the sums of its spectrum");
  return sums;
}

// Paired as WelchStream pairs them: 0 and 1, 2 and 3…, and a last one alone.
void BlockTransforms::take(std::span<const double> part, BlockTaker& taker) const {
  HalfSegments halves(detail::in_memory(2 * block_), workspace_ != nullptr ? &workspace_->state().pools : nullptr);
  SharedBlocks blocks(block_, taker);
  const auto next = [&]() -> HalfSegments::Half {
    if (part.size() < block_) return {};
    HalfSegments::Half half = halves.half_at(part.data());
    half.block = blocks.offer(part.first(detail::in_memory(block_)), std::isfinite(half.mean));
    part = part.subspan(detail::in_memory(block_));
    return half;
  };
  while (part.size() >= block_) {
    const HalfSegments::Half first = next(), second = next();
    halves.push(first, second, nullptr, nullptr);
  }
  blocks.close(part, halves.block_power());
}

}  // namespace libchar
