#pragma once
// When an algorithm took a channel out and when it let it in again; when one with several estimators handed over from
// one to another.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace libchar::fusion {

/// What was seen of the channel, or which rule of [RV] saw it.
enum class FaultRule {
  variance,         ///< its estimated variance is beyond a threshold [RV 4.34]
  residual_moment,  ///< the second moment of its residual about zero is: noise, bias or gain
  bias,             ///< its residual has a mean: bias or ramp
  gain,             ///< its residual follows the input
  noise,            ///< its residual scatters more: it stays in use, with less weight
  dead,             ///< it says nothing about the input any more
  stuck,            ///< it repeats a value that it could not repeat
  saturated,        ///< it is at the end of its range
};
constexpr std::string_view name(FaultRule rule) {
  constexpr std::string_view names[] = {"variance", "residual_moment", "bias",     "gain", "noise",
                                        "dead",     "stuck",           "saturated"};
  return names[static_cast<int>(rule)];
}

/// A stretch in which the faults could not be assigned: two sets of channels contradict each other and
/// either may be the healthy one, or most channels are off at once.
struct FaultDoubt {
  std::int64_t sample = 0;  ///< where it was seen
  bool ambiguous = false;   ///< two sets explain it alike; false: no set is consistent
  std::uint64_t one_side = 0,
                other_side = 0;  ///< ambiguous: channels, bit by bit (of the first 64)
};

struct FaultEvent {
  std::int64_t sample = 0;  ///< instant of the run, 0 = first
  int channel = 0;
  bool faulty = false;  ///< true: faulty from here on (taken out, noise: re-weighted); false: healthy again
  FaultRule rule = FaultRule::variance;
};

/// Room is made once, so that noting an event inside `step` does not allocate; events beyond it are counted.
class FaultLog {
 public:
  static constexpr std::size_t kRoom = 4096;
  static constexpr std::size_t kRoomForDoubts = 256;
  FaultLog() {
    events_.reserve(kRoom);
    doubts_.reserve(kRoomForDoubts);
  }
  FaultLog(const FaultLog& other) : FaultLog() { *this = other; }
  FaultLog& operator=(const FaultLog& other) {
    events_.assign(other.events_.begin(), other.events_.end());
    doubts_.assign(other.doubts_.begin(), other.doubts_.end());
    dropped_ = other.dropped_;
    return *this;
  }
  void note(const FaultEvent& event) {
    if (events_.size() < kRoom)
      events_.push_back(event);
    else
      ++dropped_;
  }
  void note(const FaultDoubt& doubt) {
    if (doubts_.size() < kRoomForDoubts) doubts_.push_back(doubt);
  }
  std::span<const FaultDoubt> doubts() const { return doubts_; }
  std::span<const FaultEvent> events() const { return events_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::vector<FaultEvent> events_;
  std::vector<FaultDoubt> doubts_;
  std::uint64_t dropped_ = 0;
};

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
  constexpr std::string_view names[] = {"right", "missing", "outside", "apart", "inconsistent", "no_gain"};
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
