// Welch's method on samples as they come: one segment is kept, its tail is the head of the next.

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "libchar/core/error.hpp"
#include "libchar/spectrum/segments.hpp"

namespace libchar {

using namespace welch_detail;

struct WelchStream::State {
  WelchOptions options;
  Layout layout;
  std::vector<double> window;
  Periodogram periodogram;
  Average average;
  std::vector<double> segment;  // its first `filled` samples are there
  std::size_t filled = 0;
  std::vector<double> group;  // power of the group under way, `in_group` segments of it
  std::size_t in_group = 0;
  std::uint64_t samples = 0;

  explicit State(const WelchOptions& chosen)
      : options(chosen),
        layout(layout_of(chosen.segment, chosen.overlap)),
        window(window_values(chosen.window, layout.segment)),
        periodogram(options, window),
        average(options, layout),
        segment(layout.segment),
        group(layout.segment / 2 + 1, 0.0) {}
  void take(const double* x);
};

void WelchStream::State::take(const double* x) {
  average.note_segment(periodogram.add(x, group.data()));
  if (++in_group < layout.group) return;
  average.add_group(group);
  std::fill(group.begin(), group.end(), 0.0);
  in_group = 0;
}

WelchStream::WelchStream(const WelchOptions& options) {
  check_options(options);
  if (options.segment == 0)
    throw Error({ErrorKind::usage,
                 "",
                 "",
                 "a streamed spectrum needs the length of its segments beforehand",
                 "",
                 "give a segment length"});
  state_ = std::make_unique<State>(options);
}
WelchStream::~WelchStream() = default;
WelchStream::WelchStream(WelchStream&&) noexcept = default;
WelchStream& WelchStream::operator=(WelchStream&&) noexcept = default;

void WelchStream::push(std::span<const double> samples) {
  State& s = *state_;
  s.samples += samples.size();
  const std::size_t n = s.layout.segment, hop = s.layout.hop;
  while (!samples.empty()) {
    // Whole segments inside the pushed block need no copy.
    if (s.filled == 0)
      while (samples.size() >= n) {
        s.take(samples.data());
        samples = samples.subspan(hop);
      }
    const std::size_t more = std::min(n - s.filled, samples.size());
    if (more > 0) std::memcpy(s.segment.data() + s.filled, samples.data(), more * sizeof(double));
    s.filled += more;
    samples = samples.subspan(more);
    if (s.filled < n) return;
    s.take(s.segment.data());
    std::memmove(s.segment.data(), s.segment.data() + hop, (n - hop) * sizeof(double));
    s.filled = n - hop;
  }
}

Spectrum WelchStream::finish(double rate_hz) const {
  check_rate(rate_hz);
  const State& s = *state_;
  if (s.average.used() == 0)
    throw Error({ErrorKind::numeric,
                 "",
                 "",
                 fmt::format("a spectrum with segments of {} samples needs as many without a "
                             "missing one; none was found in {} samples",
                             s.layout.segment,
                             s.samples),
                 "",
                 "choose a shorter segment"});
  Average whole = s.average;
  if (s.in_group > 0) whole.add_group(s.group);
  Spectrum spectrum = whole.spectrum(s.window, rate_hz);
  if (spectrum.dropped > 0)
    spectrum.notes.push_back(
        fmt::format("{} of {} segments touch a missing sample and were dropped",
                    spectrum.dropped,
                    spectrum.dropped + spectrum.segments));
  return spectrum;
}

}  // namespace libchar
