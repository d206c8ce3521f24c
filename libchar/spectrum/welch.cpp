// Welch's method over a record in memory: choose the segment, then sum groups of segments, in parallel and in order.

#include "libchar/spectrum/welch.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/parallel/thread_limit.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/spectrum/detail/half_pass.hpp"
#include "libchar/spectrum/detail/half_segments.hpp"
#include "libchar/spectrum/detail/segments.hpp"

namespace libchar {

using namespace welch_detail;

namespace {

// Samples of a segment from which on its transforms take as much memory as the record, and time
// that one thread would need alone.
constexpr std::uint64_t kLongSegment = std::uint64_t{1} << 21U;

struct Group {
  std::uint64_t index = 0;
  std::vector<double> power;
  std::vector<char> used;
};

// What one thread works with: halves, each transformed once, where the options allow it; else whole segments.
struct Worker {
  WelchWorkspace::State& memory;
  std::optional<WelchWorkspace::State::Piece> halves;
  std::optional<Periodogram> periodogram;
  /// No window: by halves.
  Worker(const WelchOptions& options, const Layout& layout, const std::vector<double>& window, WelchWorkspace& kept)
      : memory(kept.state()) {
    if (window.empty())
      halves = memory.take(layout.segment);
    else
      periodogram.emplace(options, window);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() {
    if (halves) memory.give_back(std::move(*halves));
  }
};

/// As many as are at work at once.
class Workers {
 public:
  explicit Workers(std::function<std::unique_ptr<Worker>()> make) : make_(std::move(make)) {}
  void lend(const auto& work) {
    std::unique_ptr<Worker> worker = idle();
    if (!worker) worker = make_();
    work(*worker);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(worker));
  }

 private:
  std::unique_ptr<Worker> idle() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return nullptr;
    auto worker = std::move(idle_.back());
    idle_.pop_back();
    return worker;
  }

  std::function<std::unique_ptr<Worker>()> make_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Worker>> idle_;
};

// The segments [index * group, (index + 1) * group) of the record.
Group sum_of_group(std::uint64_t index, std::span<const double> record, const Layout& layout, Worker& worker) {
  Group out{index, {}, {}};
  const std::uint64_t first = index * layout.group;
  const std::uint64_t last = std::min<std::uint64_t>(first + layout.group, layout.count(record.size()));
  if (!worker.halves) {
    out.power.assign(layout.segment / 2 + 1, 0.0);
    for (std::uint64_t i = first; i < last; ++i)
      out.used.push_back(worker.periodogram->add(record.data() + i * layout.hop, out.power.data()));
    return out;
  }
  // Pairs as a stream has them: the group ends with the first segment of one.
  auto& [halves, sums] = *worker.halves;
  halves.forget();
  const std::uint64_t there = layout.count(record.size()) + 1;  // halves
  for (std::uint64_t i = first; i <= last; i += 2) {
    const double* const x = record.data() + i * layout.hop;
    const HalfSegments::Half a = halves.half_at(x);
    const HalfSegments::Half b = i + 1 < there ? halves.half_at(x + layout.hop) : HalfSegments::Half();
    const auto used = halves.push(a, b, sums.get(), i < last ? sums.get() : nullptr);
    if (i > first) out.used.push_back(used.first);
    if (i < last) out.used.push_back(used.second);
  }
  halves.take_power(*sums, out.power);
  return out;
}

void take(Group&& group, Average& average) {
  average.add_group(std::move(group.power));
  for (const char used : group.used) average.note_segment(used != 0);
}

// Never more than the machine has: it would not be faster.
std::uint64_t threads_of(const WelchOptions& options) {
  const int most = processors_given();
  return static_cast<std::uint64_t>(options.threads > 0 ? std::min(options.threads, most) : most);
}

// How a record is cut into segments, and what is said of it.
struct Cutting {
  Layout layout;
  WelchOptions options;  // with the segment
  std::vector<std::string> notes;

  Cutting(std::span<const double> record, const WelchOptions& asked) : options(asked) {
    layout = layout_of(choose_segment(record, asked, notes), asked.overlap);
    options.segment = layout.segment;
  }
};

Spectrum finished(const Average& average, const std::vector<double>& window, Cutting&& cutting, double rate_hz) {
  Spectrum spectrum = average.spectrum(window, rate_hz);
  spectrum.notes = std::move(cutting.notes);
  note_dropped(spectrum.dropped, spectrum.segments, spectrum.notes);
  return spectrum;
}

void add_groups(std::span<const double> record, const Cutting& cutting, const std::vector<double>& window,
                WelchWorkspace& memory, Average& average) {
  const Layout& layout = cutting.layout;
  const std::uint64_t groups = (layout.count(record.size()) + layout.group - 1) / layout.group;
  const int threads = static_cast<int>(std::min(groups, threads_of(cutting.options)));
  if (threads <= 1) {
    Worker worker(cutting.options, layout, window, memory);
    for (std::uint64_t g = 0; g < groups; ++g) take(sum_of_group(g, record, layout, worker), average);
    return;
  }
  Workers workers([&] { return std::make_unique<Worker>(cutting.options, layout, window, memory); });
  const std::size_t most = 2 * static_cast<std::size_t>(threads);
  std::vector<Group> places(most);  // one is free again when the group `most` before has been taken
  std::uint64_t next = 0;
  const auto group_of = [](void* group) -> Group& { return *static_cast<Group*>(group); };
  parallel::Threads(threads).run([&] {
    parallel::in_order(most, {.read = [&]() -> void* {
                                if (next == groups) return nullptr;
                                Group& group = places[next % most];
                                group.index = next++;
                                return &group;
                              },
                              .first = [](void*) {},
                              .work =
                                  [&](void* group) {
                                    workers.lend([&](Worker& worker) {
                                      group_of(group) = sum_of_group(group_of(group).index, record, layout, worker);
                                    });
                                  },
                              .last = [&](void* group) { take(std::move(group_of(group)), average); }});
  });
}

}  // namespace

Spectrum welch(std::span<const double> record, double rate_hz, const WelchOptions& options, WelchWorkspace* workspace) {
  check_options(options);
  check_rate(rate_hz);
  Cutting cutting(record, options);
  const std::vector<double> window = HalfSegments::suits(cutting.options)
                                         ? std::vector<double>()
                                         : window_values(options.window, cutting.layout.segment);
  Average average(options, cutting.layout);
  WelchWorkspace own;
  add_groups(record, cutting, window, workspace != nullptr ? *workspace : own, average);
  average.note_samples(record);
  return finished(average, window, std::move(cutting), rate_hz);
}

Spectrum welch_using_up(std::vector<double> record, double rate_hz, const WelchOptions& options,
                        WelchWorkspace* workspace) {
  check_options(options);
  check_rate(rate_hz);
  Cutting cutting(record, options);
  const Layout& layout = cutting.layout;
  // What stands in the place of the samples is summed in one group, and short segments need little memory.
  if (layout.segment < kLongSegment || layout.count(record.size()) > layout.group ||
      !HalfSegments::suits(cutting.options))
    return welch(record, rate_hz, options, workspace);
  Average average(options, layout);
  average.note_samples(record);
  const int threads = static_cast<int>(threads_of(options));
  parallel::Threads arena(threads);
  arena.run([&] {
    HalvesInPlace halves(layout.hop, threads);
    for (const char used : halves.add_all(record)) average.note_segment(used != 0);
    record = std::vector<double>();  // `{}` would keep the memory
    average.add_group(halves.power());
  });
  return finished(average, {}, std::move(cutting), rate_hz);
}

std::uint64_t segment_samples(double seconds, double rate_hz) {
  const std::string got = duration_text(seconds, 6);
  if (!(rate_hz > 0))
    throw usage_error("E0205", "`segment`")
        .says("a time needs the sampling rate, which this log does not say")
        .got(got)
        .hint("give `rate_hz`, or a number of samples");
  const double samples = std::round(seconds * rate_hz);
  const bool few = samples < kShortestSegment;
  if (!few && samples <= kLongestSegment) return static_cast<std::uint64_t>(samples);
  throw usage_error("E0201", "`segment`")
      .says("at {} this is {} samples, and a segment {} {}", detail::frequency_text(rate_hz, 6), brief_text(samples, 6),
            few ? "needs at least" : "has at most", few ? kShortestSegment : kLongestSegment)
      .got(got);
}

}  // namespace libchar
