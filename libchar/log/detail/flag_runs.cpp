#include "libchar/log/detail/flag_runs.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/whole.hpp"

namespace libchar::detail {

void FlagRuns::close(std::uint64_t length, double times) {
  if (length == 0) return;
  if (closed_.empty()) closed_.assign(kLongestCounted + 1, 0.0);
  closed_[std::min(in_memory(length), kLongestCounted)] += times;
}

void FlagRuns::add_distance(std::uint64_t distance) {
  const auto d = static_cast<double>(distance);
  spacing_ += d;
  spacing2_ += d * d;
}

void FlagRuns::push_run(std::uint64_t n, std::uint64_t at) {
  if (n == 0) return;
  if (set_ == 0) first_ = seen_;
  if (set_ > 0) add_distance(seen_ - last_);
  const auto more = static_cast<double>(n - 1);  // distances of one
  spacing_ += more;
  spacing2_ += more;
  if (all()) lead_ += n;
  last_ = seen_ + n - 1;
  set_ += n;
  seen_ += n;
  const std::uint64_t before = now_;
  now_ += n;
  longest_ = std::max(longest_, now_);
  if (now_ < place_from_) return;
  if (before >= place_from_ && places_.back().second == at)
    places_.back().second += n;
  else if (before < place_from_ && places_.size() < kMostPlaces)
    places_.push_back({at - before, at + n});
}

void FlagRuns::push_without(std::uint64_t n) {
  if (n == 0) return;
  if (!all()) close(now_);
  seen_ += n;
  now_ = 0;
}

void FlagRuns::join(const FlagRuns& later, std::uint64_t at, std::uint64_t skipped) {
  if (later.seen_ == 0) return;
  const std::uint64_t across = later.lead_ > 0 && now_ > 0 ? now_ + later.lead_ : 0;
  const std::uint64_t border = at + skipped;
  std::size_t taken = 0;
  if (across >= place_from_ && across > 0) {  // one place of two
    const bool kept = now_ >= place_from_ && !places_.empty() && places_.back().second == border;
    if (kept) places_.back().second = border + later.lead_;
    if (now_ < place_from_ && places_.size() < kMostPlaces) places_.push_back({border - now_, border + later.lead_});
    taken = later.lead_ >= place_from_ ? 1 : 0;
  }
  for (std::size_t p = taken; p < later.places_.size() && places_.size() < kMostPlaces; ++p)
    places_.push_back({at + later.places_[p].first, at + later.places_[p].second});
  if (set_ > 0 && later.set_ > 0) add_distance(seen_ + later.first_ - last_);
  spacing_ += later.spacing_;
  spacing2_ += later.spacing2_;
  if (set_ == 0) first_ = seen_ + later.first_;
  if (later.set_ > 0) last_ = seen_ + later.last_;
  longest_ = std::max({longest_, later.longest_, across});
  const std::uint64_t middle = now_ + later.lead_;
  if (!all() && !later.all()) close(middle);
  for (std::size_t length = 1; length < later.closed_.size(); ++length)
    if (later.closed_[length] > 0) close(length, later.closed_[length]);
  if (all()) lead_ = seen_ + later.lead_;
  now_ = later.all() ? now_ + later.now_ : later.now_;
  set_ += later.set_;
  seen_ += later.seen_;
}

std::pair<std::uint64_t, std::uint64_t> FlagRuns::from_length(std::uint64_t least) const {
  double runs = 0, flags = 0;
  const auto add = [&](std::uint64_t length, double times) {
    if (length < least || length == 0) return;
    runs += times;
    flags += times * static_cast<double>(length);
  };
  double counted = static_cast<double>(now_);
  if (!all()) add(lead_, 1), counted += static_cast<double>(lead_);
  add(now_, 1);
  for (std::size_t length = 1; length < closed_.size(); ++length) {
    add(length, closed_[length]);
    counted += closed_[length] * static_cast<double>(length);
  }
  if (flags > 0) flags += static_cast<double>(set_) - counted;  // of runs beyond the longest counted
  return {static_cast<std::uint64_t>(runs), static_cast<std::uint64_t>(flags)};
}

std::uint64_t FlagRuns::second_longest() const {
  std::uint64_t out = 0, counted = 0;
  bool passed = false;
  const auto look = [&](std::uint64_t length, std::uint64_t times) {
    counted += length * times;
    if (length == longest_ && !passed && times > 0) {
      passed = true;
      --times;
    }
    if (times > 0) out = std::max(out, length);
  };
  if (!all()) look(lead_, 1);
  look(now_, 1);
  for (std::size_t length = 1; length < closed_.size(); ++length)
    look(length, static_cast<std::uint64_t>(closed_[length]));
  const std::uint64_t beyond = set_ - counted;
  return beyond > (passed ? 0 : longest_) ? std::max(out, std::uint64_t{kLongestCounted}) : out;
}

double FlagRuns::unevenness() const {
  if (set_ < 2) return 1;
  const double n = static_cast<double>(set_ - 1), mean = spacing_ / n;
  return std::sqrt(std::max(0.0, spacing2_ / n - mean * mean)) / mean;
}

void FlagRuns::check(StateReader& from) const {
  if (!closed_.empty() && closed_.size() != kLongestCounted + 1) from.refuse("runs of a channel");
  if (set_ > seen_ || now_ > set_ || lead_ > set_ || places_.size() > kMostPlaces) from.refuse("runs of a channel");
}

}  // namespace libchar::detail
