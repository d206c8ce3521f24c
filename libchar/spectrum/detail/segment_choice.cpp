#include "libchar/spectrum/detail/segment_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/present.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/spectrum/detail/segments.hpp"

namespace libchar::welch_detail {
namespace {

struct Run {
  std::uint64_t begin = 0, end = 0;
};

// Stretches without a missing sample.
std::vector<Run> present_runs(std::span<const double> record) {
  std::vector<Run> runs;
  const std::size_t n = record.size();
  for (std::size_t i = 0; i < n;) {
    while (i < n && !std::isfinite(record[i])) ++i;
    const std::size_t begin = i;
    i += finite_run(record.subspan(i));
    if (i > begin) runs.push_back({begin, i});
  }
  return runs;
}

std::uint64_t usable_segments(const std::vector<Run>& runs, const Layout& layout) {
  std::uint64_t count = 0;
  for (const Run& run : runs) {
    const std::uint64_t begin = (run.begin + layout.hop - 1) / layout.hop * layout.hop;
    if (begin + layout.segment <= run.end)
      count += (run.end - layout.segment - begin) / layout.hop + 1;
  }
  return count;
}

std::uint64_t longest(const std::vector<Run>& runs) {
  std::uint64_t length = 0;
  for (const Run& run : runs) length = std::max(length, run.end - run.begin);
  return length;
}

}  // namespace

std::uint64_t choose_segment(std::span<const double> record,
                             const WelchOptions& options,
                             std::vector<std::string>& notes) {
  const std::uint64_t n = record.size();
  const bool given = options.segment != 0;
  const std::uint64_t wanted = given ? options.segment : std::max(kShortestSegment, n / 4);
  std::uint64_t segment = std::min(wanted, n);
  const std::vector<Run> runs = present_runs(record);
  // Half-overlapping quarters are seven; with that many the dropped ones are not missed.
  const std::uint64_t possible =
      segment >= kShortestSegment ? layout_of(segment, options.overlap).count(n) : 0;
  const std::uint64_t enough = given ? 1 : std::min<std::uint64_t>(possible, 7);
  while (segment >= kShortestSegment &&
         usable_segments(runs, layout_of(segment, options.overlap)) < enough)
    segment /= 2;
  if (segment < kShortestSegment) {
    // Halving may step over a last chance: any run of eight.
    if (usable_segments(runs, layout_of(kShortestSegment, options.overlap)) == 0)
      throw numeric_error("E0401").says(
          "a spectrum needs at least {} consecutive samples; the longest stretch without a missing "
          "one has {}",
          kShortestSegment,
          longest(runs));
    segment = kShortestSegment;
  }
  if (segment < wanted)
    notes.push_back(fmt::format("the segment was shortened from {} to {} samples: {}",
                                wanted,
                                segment,
                                n < wanted ? "the record has no more"
                                           : "too few longer ones are without a missing sample"));
  return segment;
}

}  // namespace libchar::welch_detail
