#pragma once
// How far an estimate is off because sensors read otherwise than they were learnt to. With u the median of the sensors
// and e_i what sensor i reads beyond its usual offset and gain against u (reading_meter.hpp), a sensor is in doubt
// while the running mean over 32 instants of e_i, less the median of these means, or that of the square, is beyond what
// is usual, and for 4096 more. Those in doubt, fewer than half of all, are left out of u. While one is in doubt, the
// running mean of (estimate - m)^2 over 8 instants, less what it was where this was learnt, is added to the variance;
// m is the mean of what the sensors that are not in doubt say of u, by their usual scatter. The variance is at least
// what the method has of these sensors, and that of m where the estimate has become a mean of them. Where fewer than
// two are left, or no more than half of all, m is the median if they only scatter, independently from instant to
// instant. If not, and of two sensors, m is what that one says of u which is furthest from the estimate: any may be
// right.

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "libchar/replay/fusion_file.hpp"

namespace libchar::detail {

using Readings = std::vector<std::optional<LearntSensor::Reading>>;  ///< as learnt, a sensor a row

class SensorDoubt {
 public:
  /// A sensor without a reading is never in doubt. `usual`: of the method, in units of the samples.
  explicit SensorDoubt(Readings learnt, std::optional<LearntAlgorithm::Usual> usual = {});
  /// What a variance is: `least` at least, and what is `more` than usual of it. All 0: no sensor is in doubt.
  struct Variance {
    double least = 0, more = 0, usual = 0;
    bool any() const { return least > 0 || more > 0; }
    double of(double stated) const {
      const double without = std::max(0.0, least - stated);  // sensors its own weights still count on
      return std::max(stated, least) + std::max(0.0, more - usual - without);
    }
  };
  /// Of each instant. `estimates`: one for each column.
  const std::vector<Variance>& push(const Eigen::MatrixXd& samples, const Eigen::VectorXd& estimates);

 private:
  double middle(const Eigen::MatrixXd& samples, Eigen::Index at);
  double centre();
  double weighted_middle(const Eigen::VectorXd& samples);
  void remember(std::size_t sensor, double e);
  void judge(std::size_t sensor, double centre);
  Variance instant(const Eigen::MatrixXd& samples, Eigen::Index at, double estimate);
  struct Trusted {
    double sum = 0, weights = 0, sensors = 0, furthest = 0;
    double apart = 0;  // of two
    bool any_is_right = false;
    void add(double x, double weight) {
      if (weight == 0) return;
      apart = x - apart;
      sum += weight * x;
      weights += weight;
      sensors += 1;
    }
  };
  Variance variance(const Trusted& trusted) const;
  bool is_mean(const Trusted& trusted) const;
  void note_distance(double estimate, double u, const Trusted& trusted);

  Readings learnt_;
  std::optional<LearntAlgorithm::Usual> usual_;
  double all_weights_ = 0;
  std::vector<int> held_;
  int moved_ = 0;  // the same, of a sensor whose e_i are correlated
  std::vector<double> mean_, square_, product_, last_, sorted_;
  std::vector<double> beyond_;     // of the limits, at the last instant
  std::vector<std::size_t> here_;  // sensors that u is the median of
  std::size_t usable_ = 0;
  double seen_ = 0;  // instants
  std::vector<Variance> out_;
  double away_ = 0, slowly_away_ = 0;  // running means of (estimate - m)²
  struct {
    double cross = 0, spread = 0;  // that with what two are apart, and of its square
  } two_;
};

/// What a method usually does, from instants of its replay.
class UsualEstimates {
 public:
  /// Of a run of so many instants.
  void set_length(std::int64_t instants) { every_ = std::max<std::int64_t>(1, instants / kNotes); }
  bool notes(std::int64_t instant) const { return instant % every_ == 0; }
  void note(double estimate, double variance);
  /// `samples`: a column for each note, a row a sensor. Of the instants at which all sensors read as they usually do;
  /// empty: too few. `factor`: of the deviation that it states.
  std::optional<LearntAlgorithm::Usual> result(const Readings& learnt, const std::vector<Eigen::VectorXd>& samples,
                                               double factor) const;

 private:
  static constexpr std::int64_t kNotes = 1024;
  std::int64_t every_ = 1;
  std::vector<double> estimates_, variances_;
};

}  // namespace libchar::detail
