#include "libchar/characterize/detail/still.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/signs/motion.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kFewestSamples = 64;  ///< of a series
constexpr double kMostMissing = 0.01;         ///< share: filled gaps are stiller than any sensor

[[noreturn]] void refuse_still(const std::string& file,
                               const std::string& what,
                               const std::string& hint) {
  throw Error({ErrorKind::numeric, "E0705", file, what, "", hint});
}

/// What is left of a record between stretches in motion: the longest part.
Interval longest_between(std::vector<Interval> moving, double end_s) {
  std::sort(moving.begin(), moving.end(), [](const Interval& a, const Interval& b) {
    return a.low < b.low;
  });
  Interval best;
  double from = 0;
  const auto offer = [&](double to) {
    if (to - from > best.high - best.low) best = {from, to};
  };
  for (const Interval& stretch : moving) {
    offer(stretch.low);
    from = std::max(from, stretch.high);
  }
  offer(end_s);
  return best;
}

}  // namespace

void StillSearch::begin(const LogInfo& so_far) {
  means_.assign(so_far.channels.size(), {});
}

void StillSearch::block(const SampleBlock& samples) {
  for (std::size_t c = 0; c < means_.size(); ++c)
    means_[c].push({samples.channels[c], samples.rows});
}

Stretch StillSearch::finish(const LogInfo& log) const {
  if (!(log.time.rate_hz > 0))
    refuse_still(
        log.file, "the rate is not known: no still stretch can be searched", "give `rate_hz`");
  std::vector<Interval> moving;
  Stretch out;
  std::size_t tested = 0;
  for (std::size_t c = 0; c < means_.size(); ++c) {
    const MeanMeter& means = means_[c];
    const auto samples = static_cast<double>(means.samples());
    if (means.samples() < kFewestSamples ||
        static_cast<double>(means.missing()) > kMostMissing * samples)
      continue;
    const Motion motion = find_motion(means.series(log.time.rate_hz));
    if (!motion.tested) continue;
    ++tested;
    if (motion.whole)
      refuse_still(log.file,
                   fmt::format("the channel {} moves throughout: the log has no still stretch",
                               log.channels[c].name),
                   "name the stretch with `still` FROM..TO, or choose other `channels`");
    if (!motion.moving_s.empty()) out.moving.push_back(log.channels[c].name);
    moving.insert(moving.end(), motion.moving_s.begin(), motion.moving_s.end());
  }
  if (tested == 0)
    refuse_still(log.file,
                 "no channel can be searched for a still stretch: they are short (2048 samples are "
                 "needed), have many missing samples, or mostly repeat their values",
                 "name the stretch with `still` FROM..TO");
  const double end_s = static_cast<double>(log.samples) / log.time.rate_hz;
  const Interval longest = longest_between(std::move(moving), end_s);
  out.from_s = longest.low;
  out.to_s = longest.high;
  out.found = true;
  out.whole = longest.low <= 0 && longest.high >= end_s;
  return out;
}

void check_still(const StillOptions& still, const ReadOptions& reading) {
  if (!still.search && !still.stretch_s) return;
  const auto refuse = [](const std::string& what, const std::string& got) {
    throw Error({ErrorKind::usage, "E0704", "", what, got, ""});
  };
  if (reading.from_s || reading.to_s)
    refuse("`still` chooses the stretch: it does not go with `from_s` and `to_s`", "");
  if (!still.stretch_s) return;
  const Interval& s = *still.stretch_s;
  if (!(s.low >= 0) || !(s.low < s.high))
    refuse("the still stretch does not go from a time to a later one",
           fmt::format("{} to {} s", brief_text(s.low, 6), brief_text(s.high, 6)));
}

std::string stretch_sentence(const Stretch& stretch) {
  if (stretch.whole) return "Nothing moves in the recording: all of it was analysed.";
  std::string text = fmt::format("Only the stretch from {} to {} s was analysed, {}",
                                 brief_text(stretch.from_s, 6),
                                 brief_text(stretch.to_s, 6),
                                 stretch.found ? "the longest in which nothing moves" : "as asked");
  if (stretch.moving.empty()) return text + ".";
  const std::size_t shown = std::min<std::size_t>(stretch.moving.size(), 6);
  text += " (moving outside: ";
  for (std::size_t i = 0; i < shown; ++i) text += (i == 0 ? "" : ", ") + stretch.moving[i];
  return text + (shown < stretch.moving.size() ? ", …)." : ").");
}

}  // namespace libchar
