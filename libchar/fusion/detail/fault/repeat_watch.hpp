#pragma once
// A sensor that is stuck or stands at the end of its range says the same again, exactly. How much a
// repetition proves depends on what a healthy sensor would do: one with steps of q whose samples differ by a
// in the mean (a not above what its noise of deviation s does) repeats by chance with probability about
// q / (pi a) while its input stands still, and hardly ever when the input has moved by D since:
//
//   P = min(1, q / (pi a)) exp(-D^2 / 4 s^2),  evidence <- evidence - ln P a repetition where P < .05
//
// P is never taken below the rate at which the sensor has repeated unexpectedly before: one that holds
// its samples (20 Hz in a log of 200 Hz) is not stuck. At the end of the range the others need not
// move (they may stand there too): the sensor came there by a step of m and repeats its extreme, P = q / m.
//
// Nor is one stuck before it has repeated three times as often in a row as it ever did and went on:
// what a healthy sensor of coarse steps and slow response does, it has done before.
//
// A range once known is known: the sensor is saturated whenever it says that value.

#include <algorithm>
#include <cmath>
#include <vector>

namespace libchar::fusion {

class RepeatWatch {
 public:
  enum class State : char { moving, stuck, saturated };

  RepeatWatch(std::size_t sensors, double threshold) : threshold_(threshold), last_(sensors, kNone), all_(sensors) {}

  /// Sample y of sensor i, of deviation s; the others say the input is at x. True when it is, or was
  /// until now, anything but moving.
  bool take_in(std::size_t i, double y, double x, double deviation) {
    Sensor& s = all_[i];
    const State before = s.state;
    if (y == last_[i]) {
      s.run += 1;
      repeated(s, y, x, deviation);
      s.suspect = s.evidence != 0 || s.end_evidence != 0 || s.ends;
      return s.state != State::moving;
    }
    if (s.run > 0) end_run(s);
    const double by = std::abs(y - last_[i]);
    if (last_[i] != kNone) {
      s.step = by < s.step ? by : s.step;
      s.chances += 1;
    }
    if (s.chances > 1) s.change += (by - s.change) / std::min(s.chances, kChangeMemory);
    s.far_moves += by > kManySteps * s.step ? 1 : 0;
    s.counted = false;
    s.came_by = by;
    s.x_there = x;
    last_[i] = y;
    if (y > s.high || y < s.low || s.suspect) moved(s, y);
    return s.state != State::moving || before != State::moving;
  }
  State state(std::size_t i) const { return all_[i].state; }
  /// The end of its range that it stands at lies below (above) x by more than `margin`.
  bool others_beyond(std::size_t i, double x, double margin) const {
    return last_[i] == all_[i].high_end ? x > last_[i] + margin : x < last_[i] - margin;
  }

 private:
  static constexpr double kNone = 1e300;
  static constexpr double kEvidenceOfEnd = 12;
  static constexpr double kManySteps = 64;
  static constexpr double kChangeMemory = 1000;
  static constexpr double kSmallestChance = 1e-6;
  static constexpr double kTimesLongest = 3, kFirstRun = 4;

  struct Sensor {
    double x_there = 0;      // the input when the value came that repeats
    double step = kNone;     // the smallest step ever seen
    double change = 0;       // mean of |y - last y|
    double came_by = kNone;  // the step to the value that repeats
    double low = kNone, high = -kNone;
    double low_end = -kNone, high_end = kNone;
    double evidence = 0, end_evidence = 0;
    double unexpected = 0.5, chances = 1;
    double far_held = 0.5, far_moves = 1;  // repetitions after a step of many steps
    double run = 0, longest = 0;           // repetitions in a row: now, and at most so far
    bool was_unexpected = false, counted = false;
    bool ends = false;     // an end of its range is known
    bool suspect = false;  // that, or repetitions have proved something: its next move is looked at
    State state = State::moving;
  };

  static void end_run(Sensor& s) {
    // A run that was taken for a fault says less: it may have been one.
    const double most = std::max(2 * s.longest, kFirstRun);
    s.longest = std::max(s.longest, s.state == State::stuck ? std::min(s.run, most) : s.run);
    s.run = 0;
  }

  static void moved(Sensor& s, double y) {
    s.low = y < s.low ? y : s.low;
    s.high = y > s.high ? y : s.high;
    s.evidence = s.end_evidence = 0;
    s.suspect = s.ends;
    s.was_unexpected = false;
    // Beyond its end: that was none.
    if (y > s.high_end) s.high_end = kNone;
    if (y < s.low_end) s.low_end = -kNone;
    s.state = y == s.high_end || y == s.low_end ? State::saturated : State::moving;
  }

  void repeated(Sensor& s, double y, double x, double deviation) const {
    if (s.state != State::moving) return;
    const double past = s.unexpected / s.chances;
    s.change -= s.change / std::min(s.chances, kChangeMemory);
    const double still = std::min(1.0, s.step / (3.14 * std::min(s.change, 1.13 * deviation)));
    const double off = std::abs(x - s.x_there) > s.step ? std::abs(x - s.x_there) - s.step : 0;
    const double t = off / deviation;
    const double chance = still * std::exp(-std::min(t * t / 4, 30.0));
    if (chance < 0.05) {
      s.unexpected += s.was_unexpected ? 0 : 1;
      s.was_unexpected = true;
      s.evidence -= std::log(std::max({chance, past, kSmallestChance}));
    }
    const bool far = s.came_by > kManySteps * s.step && s.came_by < kNone / 2;
    const bool end = far && (y >= s.high || y <= s.low);
    if (far && !end && !s.counted) s.far_held += 1;
    s.counted = true;
    const double held = s.far_held / s.far_moves;
    if (end) s.end_evidence -= std::log(std::max({s.step / s.came_by, held, kSmallestChance}));
    if (s.end_evidence > kEvidenceOfEnd) {
      (y >= s.high ? s.high_end : s.low_end) = y;
      s.ends = true;
      s.state = State::saturated;
    } else if (s.evidence > threshold_ && s.run > kTimesLongest * s.longest) {
      s.state = State::stuck;
    }
  }

  double threshold_;
  std::vector<double> last_;
  std::vector<Sensor> all_;
};

}  // namespace libchar::fusion
