#include "libchar/characterize/detail/still.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/fit/motion.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostMeans = std::size_t{1} << 16U;
constexpr double kMostMissing = 0.01;  ///< share: filled gaps are stiller than any sensor

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

void MeansOfRecord::end_mean() {
  const double before = mean_.empty() ? 0 : mean_.back();
  mean_.push_back(present_ > 0 ? sum_ / static_cast<double>(present_) : before);
  sum_ = 0;
  in_mean_ = present_ = 0;
  if (mean_.size() < kMostMeans) return;
  for (std::size_t i = 0; i < mean_.size() / 2; ++i)
    mean_[i] = 0.5 * (mean_[2 * i] + mean_[2 * i + 1]);
  mean_.resize(mean_.size() / 2);
  per_mean_ *= 2;
}

void MeansOfRecord::push(std::span<const double> samples) {
  for (const double x : samples) {
    ++samples_;
    ++in_mean_;
    if (std::isfinite(x)) {
      sum_ += x;
      ++present_;
    } else {
      ++missing_;
    }
    if (in_mean_ == per_mean_) end_mean();
  }
}

EventSeries MeansOfRecord::series(double rate_hz) const {
  EventSeries series;
  series.value = mean_;
  series.per_point = per_mean_;
  series.step_s = static_cast<double>(per_mean_) / rate_hz;
  return series;
}

double MeansOfRecord::missing() const {
  return samples_ == 0 ? 1 : static_cast<double>(missing_) / static_cast<double>(samples_);
}

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
    if (means_[c].missing() > kMostMissing) continue;
    const Motion motion = find_motion(means_[c].series(log.time.rate_hz));
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
