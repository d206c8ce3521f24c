#pragma once
// When an algorithm took a channel out and when it let it in again.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace libchar::fusion {

/// Which rule took the channel out.
enum class FaultRule {
  variance,         ///< its estimated variance is beyond a threshold [RV 4.34]
  residual_moment,  ///< the second moment of its residual about zero is: noise, bias or gain
};
constexpr std::string_view name(FaultRule rule) {
  return rule == FaultRule::variance ? "variance" : "residual_moment";
}

struct FaultEvent {
  std::int64_t sample = 0;  ///< instant of the run, 0 = first
  int channel = 0;
  bool faulty = false;  ///< true: taken out from here on; false: in again
  FaultRule rule = FaultRule::variance;
};

/// Room is made once, so that noting an event inside `step` does not allocate; events beyond it are
/// counted.
class FaultLog {
 public:
  static constexpr std::size_t kRoom = 4096;
  FaultLog() { events_.reserve(kRoom); }
  FaultLog(const FaultLog& other) : FaultLog() { *this = other; }
  FaultLog& operator=(const FaultLog& other) {
    events_.assign(other.events_.begin(), other.events_.end());
    dropped_ = other.dropped_;
    return *this;
  }
  void note(const FaultEvent& event) {
    if (events_.size() < kRoom)
      events_.push_back(event);
    else
      ++dropped_;
  }
  std::span<const FaultEvent> events() const { return events_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::vector<FaultEvent> events_;
  std::uint64_t dropped_ = 0;
};

}  // namespace libchar::fusion
