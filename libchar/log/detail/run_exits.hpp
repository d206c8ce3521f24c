#pragma once
// How values leave long runs of one value: what rests goes on by a usual step, what hung jumps to where the quantity
// is.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "libchar/core/numeric/state_archive.hpp"

namespace libchar::detail {

class RunExits {
 public:
  static constexpr std::uint64_t kLong = 100;  ///< samples; shorter runs are not looked at

  /// A run of so many samples is over: by how much the next one is off, 0 where none follows directly. `first`: it
  /// began with the record.
  void leave(std::uint64_t samples, double step, bool first) {
    step = std::fabs(step);
    if (first) first_ = step;
    if (samples < kLong || !(step > 0)) return;
    const auto power = static_cast<std::uint64_t>(std::ilogb(step) + kBias);
    const auto at = std::lower_bound(longest_.begin(), longest_.end(), std::pair(power, std::uint64_t{0}));
    if (at != longest_.end() && at->first == power)
      at->second = std::max(at->second, samples);
    else
      longest_.insert(at, {power, samples});
  }
  /// `later` follows, whose first value is off by `step` from the last one; 0: it goes on with that value, of which
  /// `own` samples stood here and `more` there. `all`: this part has but one value.
  void join(const RunExits& later, std::uint64_t own, std::uint64_t more, double step, bool all) {
    add_runs(later);
    if (step != 0)
      leave(own, step, all);
    else if (!std::isnan(later.first_))
      leave(own + more, later.first_, all);
  }
  /// `later` stands behind missing samples.
  void join_apart(const RunExits& later, bool all) {
    add_runs(later);
    leave(0, 0, all);
  }
  /// The longest run that was left by more than `step` (a factor of two), or by no more.
  std::uint64_t longest(double step, bool beyond) const {
    std::uint64_t out = 0;
    for (const auto& [power, samples] : longest_)
      if ((std::ldexp(1, static_cast<int>(power) - kBias) > step) == beyond) out = std::max(out, samples);
    return out;
  }

  static void layout(auto& at, auto& exits) {
    at(exits.first_);
    at.list(exits.longest_, 16, [&](auto& one) { at(one.first, one.second); });
  }
  void check(StateReader& from) const {
    if (!std::is_sorted(longest_.begin(), longest_.end()) || (!longest_.empty() && longest_.back().first > 2 * kBias))
      from.refuse("runs of a channel");
  }

 private:
  void add_runs(const RunExits& later) {
    for (const auto& [power, samples] : later.longest_)
      leave(samples, std::ldexp(1, static_cast<int>(power) - kBias), false);
  }

  static constexpr int kBias = 1100;                              ///< powers of two of any double are above -1100
  double first_ = std::numeric_limits<double>::quiet_NaN();       ///< by how much the first run was left
  std::vector<std::pair<std::uint64_t, std::uint64_t>> longest_;  ///< by the power of two of what it was left by
};

}  // namespace libchar::detail
