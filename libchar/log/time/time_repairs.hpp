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
  std::uint64_t count() const {
    return last < first ? 0 : static_cast<std::uint64_t>(last - first + 1);
  }
};

/// Of the `gap` missing grid points behind a row `before_ns` after the first stamp: those from
/// `from_ns` on and before `to_ns` (INT64_MAX = no end), also after the first stamp.
GridStretch gap_in_window(
    std::int64_t gap, double before_ns, double dt_ns, std::int64_t from_ns, std::int64_t to_ns);

/// Steps that are none of the grid's: where many in a row have one length, that is another rate.
class RateWatch {
 public:
  /// An odd step that leads to this row, `after_first_ns` after the first stamp. True with the first
  /// of a new run: its place is to be kept.
  bool add(std::uint64_t row, double intervals, std::int64_t after_first_ns);
  /// The run under way is over.
  void end();
  void keep_place(std::string place) { place_ = std::move(place); }
  std::uint64_t rows() const { return rows_; }     ///< in all such runs
  double intervals() const { return intervals_; }  ///< the step of the first one
  std::int64_t began_ns() const { return began_ns_; }
  std::int64_t ended_ns() const { return ended_ns_; }  ///< of the last one, its last row but one
  const std::string& place() const { return began_; }
  /// Rows are left out, one or more in each step: the grid holds.
  bool whole() const;

 private:
  void count(double near, double share);
  static constexpr std::size_t kRun = 32, kShortRun = 8;
  std::vector<double> steps_;
  std::uint64_t first_row_ = 0, last_row_ = 0, rows_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0, began_ns_ = 0, ended_ns_ = 0;
  double intervals_ = 0;
  bool counted_ = false;  // the run under way
  std::string place_, began_;
};

}  // namespace libchar
