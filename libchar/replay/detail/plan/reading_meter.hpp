#pragma once
// What each sensor reads relative to the others, so that another log can be held against it: with u the median of the
// sensors at an instant,
//
//   y_i - u = a_i + b_i u + e_i
//
// b the weighted median of the slopes of blocks, a the median of what is left of their means. In each block
// q_i = mean(e_i) and rms(e_i). Medians leave faults of up to half of the log out; the median of the
// sensors leaves fewer than half of them out.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/replay/fusion_file.hpp"

namespace libchar::detail {

/// Accumulates over consecutive instants, in blocks; memory does not grow with their number.
class ReadingMeter {
 public:
  /// Of `sensors` that see one input alike, at least three.
  ReadingMeter(Eigen::Index sensors, std::int64_t instants);
  /// A column an instant, a row a sensor; missing samples are left out.
  void push(const Eigen::MatrixXd& samples);
  using Readings = std::vector<std::optional<LearntSensor::Reading>>;
  /// Of each sensor; none where it has too few samples. What is usual holds for nine blocks of ten.
  Readings result() const;
  /// The same, but what is usual is that of the better half of the blocks, so that faults of up to
  /// half of the log are not in it.
  Readings steady() const;

  /// Where offsets are a fifth of the mean square of what the sensors differ by, or more: of each sensor its middle
  /// distance from the median of all, less the level, the mean of these distances without those that stand apart.
  struct Level {
    std::vector<double> offsets;
    double sd = 0;  ///< of the level; 1.96 of it hold 95 %
  };
  std::optional<Level> level() const;

  /// Where a sensor reads otherwise than it was learnt, in at least two blocks one after the other, and in more than
  /// outliers of all sensors explain.
  struct Change {
    std::size_t sensor = 0;
    double offset = 0;              ///< largest mean beyond what was learnt
    double scatter = 1;             ///< rms over the learnt one, the furthest from 1
    std::int64_t from = 0, to = 0;  ///< instants
    bool to_end = false;
  };
  /// `quieter`: also where it scatters less, as one does that fails for most of the log.
  std::vector<Change> changes(const Readings& learnt, bool quieter = false) const;

 private:
  struct Sums {
    double n = 0, u = 0, r = 0, uu = 0, ur = 0, rr = 0;  // of u and r less their first values
    double u0 = 0, r0 = 0;
  };
  struct Fit {
    double mean = 0, rms = 0;
  };
  static Fit fit(const Sums& sums, double a, double b);
  static bool beyond(const Fit& block, const LearntSensor::Reading& usual, bool quieter);
  std::int64_t least_in_a_row(const Readings& learnt, bool quieter) const;
  void close();
  Readings readings(double share, double mean_factor, double rms_factor) const;

  std::size_t n_;
  std::int64_t block_, stride_ = 1, seen_ = 0, closed_ = 0;
  std::vector<Sums> now_;
  std::vector<std::vector<Sums>> blocks_;  // one of `stride_` is kept
  std::vector<double> sorted_;
};

/// Of the instants that a meter saw.
struct Clock {
  double start_s = 0, rate_hz = 1;
};

/// Of a sensor, before it was fused.
struct TakenOut {
  double offset = 0, gain = 0;
};

/// Sensors that read otherwise than they do for most of the log they are judged by, or than all
/// others throughout: offset, gain and noise of one that stand apart from those of the rest. `taken_out`: what the
/// meter did not see.
void warn_of_readings(const ReadingMeter& meter, const std::vector<std::string>& names,
                      const std::vector<std::string>& units, const Clock& clock, const std::vector<TakenOut>& taken_out,
                      Findings& warnings);

void warn_of_changes(const std::vector<ReadingMeter::Change>& changes, const std::vector<std::string>& names,
                     const std::vector<std::string>& units, const Clock& clock, Findings& warnings);

}  // namespace libchar::detail
