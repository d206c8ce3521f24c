#pragma once
// What each sensor reads relative to the others, so that another log can be held against it: with u the median of the
// sensors at an instant,
//
//   y_i - u = a_i + b_i u + e_i
//
// b the weighted median of the slopes of blocks, a the median of what is left of their means. In each block
// q_i = mean(e_i) and rms(e_i). Medians leave faults of up to half of the log out; the median of the
// sensors leaves fewer than half of them out. Of two sensors u is their mean, and both are as far from it: that one of
// them reads otherwise is seen, not which.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/replay/common_errors.hpp"
#include "libchar/replay/fusion_file.hpp"

namespace libchar::detail {

/// Of a sensor, before it was fused.
struct TakenOut {
  double offset = 0, gain = 0;
};

/// Accumulates over consecutive instants, in blocks; memory does not grow with their number.
class ReadingMeter {
 public:
  /// Of `sensors` that see one input alike, at least two.
  ReadingMeter(Eigen::Index sensors, std::int64_t instants);
  std::size_t sensors() const { return n_; }
  /// A column an instant, a row a sensor; missing samples are left out.
  void push(const Eigen::MatrixXd& samples);
  /// The same beside a reference, a value an instant, in the place of the median: in every call or in none.
  void push(const Eigen::MatrixXd& samples, const Eigen::RowVectorXd& truth);
  using Readings = std::vector<std::optional<LearntSensor::Reading>>;
  /// Of each sensor; none where it has too few samples. What is usual holds for nine blocks of ten.
  Readings result() const;
  /// The same, but what is usual is that of the better half of the blocks, so that faults of up to
  /// half of the log are not in it.
  Readings steady() const;

  /// Of each sensor its middle distance from the median of all, and `taken_out` of what was taken out of it before
  /// (at the middle input), less the level: the mean of these distances without those that stand apart. Of three or
  /// more.
  struct Level {
    std::vector<double> offsets;  ///< 0: not worth taking out
    bool matters = false;         ///< one of them is not
    CommonErrors common;          ///< 1.96 of a deviation hold 95 %; the level is that of the middle input
  };
  std::optional<Level> level(const std::vector<TakenOut>& taken_out) const;

  /// Where a sensor reads otherwise than it was learnt, in at least two blocks one after the other, and in more than
  /// outliers of all sensors explain.
  struct Change {
    std::size_t sensor = 0;         ///< of two: the first stands for both
    double offset = 0;              ///< largest mean beyond what was learnt
    double scatter = 1;             ///< rms over the learnt one, the furthest from 1
    std::int64_t from = 0, to = 0;  ///< instants
    bool to_end = false;
  };
  /// What the sensors were where this was learnt, for a log in which some are missing from the start.
  void expect(const Readings& learnt);

  /// `quieter`: also where it scatters less, as one does that fails for most of the log; none where most change.
  std::vector<Change> changes(const Readings& learnt, bool quieter = false) const;

  /// Of each sensor the rms over what it is from sample to sample, 1 where neighbours are independent: an error that is
  /// slow beside others that are not is its own. Medians over the blocks.
  std::vector<std::optional<double>> slow_scatter(const Readings& readings) const;

  /// Where fused with what was learnt here: `result()`, but `steady()` of a sensor that failed for a part of it.
  Readings learnt() const;

  /// Of each sensor the share of its blocks with outliers, single samples far beyond the scatter of the others of the
  /// block and what is usual; such a block says nothing of scatter.
  std::vector<double> with_outliers(const Readings& readings) const;

  /// Of each sensor the share of its samples that repeat the one before: coarse steps, or values that are held.
  std::vector<double> repeated() const;

  /// A gain that moves from one end of the log to the other (a line or a step through those of eight parts, each
  /// from what is left of the means of its blocks), by more than chance does in a sound array in so many. `learnt`: or
  /// is another than there.
  struct GainDrift {
    std::size_t sensor = 0;
    double from = 0, to = 0;  ///< beyond one
  };
  std::vector<GainDrift> gain_drifts(double false_alarm, const Readings* learnt = nullptr) const;

  /// A sensor that is late beside the median u: with m = (u[k+1] - u[k-1]) / 2, what is left of it is e = -d m.
  struct Delay {
    std::size_t sensor = 0;
    double samples = 0;  ///< d; early: below 0
    double share = 0;    ///< of the mean square of e, in the middle block of those that move
  };
  /// Those that are resolved and much of what the sensor scatters.
  std::vector<Delay> delays() const;

 private:
  struct Motion {
    double n = 0, m = 0, mm = 0, mu = 0, mr = 0;  // of half the difference of u two apart
    double u = 0;                                 // before the last
    std::int64_t at = -1;                         // instant of it
  };
  struct Sums {
    double n = 0, u = 0, r = 0, uu = 0, ur = 0, rr = 0;  // of u and r less their first values
    double u0 = 0, r0 = 0;
    double steps = 0, suu = 0, sur = 0, srr = 0;  // of the differences between neighbours
    double last_u = 0, last_r = 0;
    Motion motion;
    double largest = 0;      // square of a step of r
    std::int64_t last = -1;  // instant of these
  };
  struct Line {
    double from = 0, to = 0, error = 0;  // at both ends; of their difference
    double change() const { return std::abs(to - from); }
    double away(double gain) const { return std::max(std::abs(to - gain), std::abs(from - gain)); }
  };
  struct Fit {
    double mean = 0, rms = 0;
  };
  static Fit fit(const Sums& sums, double a, double b);
  struct Limits {
    double least = 0;  ///< what scatters less is taken to scatter so much
    bool quieter = false;
  };
  Limits limits(const Readings& learnt, bool quieter) const;
  double middle(const Eigen::MatrixXd& samples, Eigen::Index at, bool& enough, bool& whole);
  void take(const Eigen::MatrixXd& samples, Eigen::Index at, double u, bool whole);
  bool pair() const { return n_ == 2 && !truth_; }
  static bool outlying(const Sums& sums, double usual_rms);
  static bool beyond(const Sums& sums, const LearntSensor::Reading& usual, const Limits& limits, double motion);
  std::vector<double> motion_factors(std::size_t sensor, const LearntSensor::Reading& usual) const;
  struct LeastRow {
    std::int64_t any = 2, shifted = 2;  // blocks
    bool lasts = false, alone = false;  // more noise counts as `shifted`; one block far off is enough
  };
  static bool shifted(const Sums& sums, const LearntSensor::Reading& usual);
  static bool noisy(const Sums& sums, const LearntSensor::Reading& usual);
  static bool far_off(const Sums& sums, const LearntSensor::Reading& usual, const Limits& limits, double motion);
  struct Blocks {
    std::vector<char> beyond;
    std::vector<double> motion;  ///< factors; empty: nothing is known of the sensor
  };
  std::vector<Blocks> blocks_beyond(const Readings& learnt, const Limits& limits) const;
  std::vector<LeastRow> least_in_a_row(const std::vector<Blocks>& sensors, const Limits& limits) const;
  void close();
  Readings readings(double share, double mean_factor, double rms_factor) const;
  bool tells_gains() const;
  std::optional<Line> gain_line(std::size_t sensor) const;
  using Slopes = std::vector<std::pair<double, double>>;  // with their weights
  struct Squares {
    double uu = 0, ur = 0, rr = 0;  // sums about the mean
  };
  std::vector<Squares> squares_within(std::size_t sensor, std::size_t from, std::size_t to) const;
  std::vector<Squares> squares_between(std::size_t sensor, std::size_t from, std::size_t to) const;
  static Slopes slopes_of(const std::vector<Squares>& squares);
  double median_noise(double& moves) const;
  struct Place;
  double common_gain_sd(const std::vector<Place>& places, const std::vector<TakenOut>& taken_out) const;

  std::size_t n_;
  bool truth_ = false;  // u is a reference
  std::int64_t block_, stride_ = 1, seen_ = 0, closed_ = 0;
  std::vector<Sums> now_;
  struct Neighbours {
    double all = 0, same = 0, last = 0;
  };
  std::vector<Neighbours> neighbours_;     // of each sensor
  std::vector<std::vector<Sums>> blocks_;  // one of `stride_` is kept
  std::vector<double> sorted_;
  /// What a sensor is beside the median of all: where one is missing, the median of the rest is none of all.
  struct Usual {
    double offset = 0, gain = 0;
  };
  std::vector<Usual> usual_;
  double whole_ = 0;  // instants at which all were present
};

}  // namespace libchar::detail
