#pragma once
// When an algorithm with several estimators handed over from one to another.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace libchar::fusion {

/// Whose estimate is given out.
enum class Lead : char {
  baseline,   ///< always right
  network,    ///< learnt from the reference, on all sensors
  retrained,  ///< the same, learnt again without a sensor that fails
  past,       ///< learnt from the baseline's own past
};
constexpr std::string_view name(Lead lead) {
  constexpr std::string_view names[] = {"baseline", "network", "retrained", "past"};
  return names[static_cast<int>(lead)];
}

/// Why the lead changed.
enum class HandOverReason : char {
  right,         ///< the network is right again, or for the first time
  missing,       ///< a sensor that it needs has no sample or has failed
  outside,       ///< the sensors are outside of what it learnt
  apart,         ///< it is further from the baseline than the intervals of both allow
  inconsistent,  ///< the sensors disagree in another way than where it learnt
  no_gain,       ///< it is no better than the baseline any more
};
constexpr std::string_view name(HandOverReason reason) {
  constexpr std::string_view names[] = {
      "right", "missing", "outside", "apart", "inconsistent", "no_gain"};
  return names[static_cast<int>(reason)];
}

struct HandOver {
  std::int64_t sample = 0;  ///< instant of the run, 0 = first
  Lead to = Lead::baseline;
  HandOverReason reason = HandOverReason::right;
};

/// Room is made once, so that `step` does not allocate; hand-overs beyond it are counted.
class HandOverLog {
 public:
  static constexpr std::size_t kRoom = 4096;
  HandOverLog() { events_.reserve(kRoom); }
  void note(const HandOver& event) {
    if (events_.size() < kRoom)
      events_.push_back(event);
    else
      ++dropped_;
  }
  std::span<const HandOver> events() const { return events_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::vector<HandOver> events_;
  std::uint64_t dropped_ = 0;
};

}  // namespace libchar::fusion
