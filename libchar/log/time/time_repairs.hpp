#pragma once
// What is known of a stamp that is not one regular step behind the last: how much of a gap lies
// inside the window that was asked for, and whether such steps are another rate.

#include <cstdint>
#include <string>
#include <vector>

namespace libchar {

/// Grid points first … last behind a row; none when last < first.
struct GridStretch {
  std::int64_t first = 1, last = 0;
  std::uint64_t count() const { return last < first ? 0 : static_cast<std::uint64_t>(last - first + 1); }
};

/// Of the `gap` missing grid points behind a row `before_ns` after the first stamp: those from
/// `from_ns` on and before `to_ns` (INT64_MAX = no end), also after the first stamp.
GridStretch gap_in_window(std::int64_t gap, double before_ns, double dt_ns, std::int64_t from_ns, std::int64_t to_ns);

/// Rows that follow each other in steps of one length, which is not the grid's.
struct OddRun {
  std::uint64_t rows = 0;
  double intervals = 0;  ///< a step
  std::int64_t began_ns = 0,
               ended_ns = 0;  ///< after the first stamp: the rows before the first and the last step
  std::string place;          ///< of the former
  /// Rows are left out, one or more in each step: the grid holds.
  bool whole() const;
};

/// Gaps as alike as the stretches between them: a slow link sends what it gathered, or a sensor sleeps.
class Bursts {
 public:
  /// A gap behind the row at that time after the first stamp, and how long it is, ns.
  void add(double after_first_ns, double gap_ns);
  /// From one to the next, where all are as far apart and too short for a sensor that is switched on for them, ns;
  /// else 0.
  double period() const;

 private:
  static constexpr std::size_t kMost = 4096;
  std::vector<double> ends_, gaps_;
};

/// Where steps that are none of the grid's are another rate.
class RateWatch {
 public:
  /// An odd step that leads to this row from one `after_first_ns` after the first stamp. True where it
  /// may begin a run: its place is to be kept.
  bool add(std::uint64_t row, double intervals, std::int64_t after_first_ns);
  /// The run under way is over.
  void end();
  void keep_place(std::string place) { place_ = std::move(place); }
  const OddRun& longest() const { return longest_; }

 private:
  void count(double near, double share);
  static constexpr std::size_t kTogether = 32, kShortRun = 8;
  std::vector<double> steps_;  // not counted yet
  std::uint64_t first_row_ = 0, last_row_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
  std::string place_;
  OddRun run_, longest_;
};

}  // namespace libchar
