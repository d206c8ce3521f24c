#pragma once
// What the disagreement of sensors is made of.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "libchar/core/interval.hpp"
#include "libchar/fusion/alignment.hpp"

namespace libchar::fusion {

/// Parts of the mean square of a channel's error, in the order in which they are taken out.
enum class ErrorPart { offset, gain, cross, delay, jitter, noise };
inline constexpr std::size_t kErrorParts = 6;

struct PartShare {
  double share = 0;   ///< of the channel's mean square error
  Interval ci95;      ///< by batches; NaN: too few
  double saving = 0;  ///< share of the fused error (its RMS) that would go if this were gone here
};

struct ChannelBudget {
  double rms = 0;  ///< of the channel's error; NaN: none
  std::vector<PartShare> parts;
};

struct ErrorBudget {
  std::vector<ChannelBudget> channels;
  std::vector<double> savings;  ///< a part: were it gone from every channel
  /// RMS of the mean's error (with a truth), or of the mean of the others against each channel (blind),
  /// on the same instants: as recorded, and aligned.
  double before = 0, after = 0;
  std::int64_t instants = 0;
};

/// Accumulates over consecutive instants; memory does not grow with their number.
class BudgetMeter {
 public:
  /// `instants`: how many will come, for the length of the batches. `with_truth`: columns have one.
  BudgetMeter(Eigen::Index channels, Eigen::Index axes, std::int64_t instants, bool with_truth);
  /// One instant: samples as recorded, with their delays alone taken out (`in_time`), aligned, the
  /// mean of each further axis, the truth (NaN when blind). An instant at which anything is missing
  /// is left out.
  void push(const Eigen::VectorXd& recorded,
            const Eigen::VectorXd& undelayed,
            const Eigen::VectorXd& aligned,
            const Eigen::VectorXd& cross,
            double truth);
  ErrorBudget result() const;

 private:
  struct Instant {
    Eigen::VectorXd recorded, undelayed, aligned, cross;
    double x = 0;
    bool complete = false;
  };
  struct Sums {                          // of one batch
    Eigen::MatrixXd regressors;          // Gram matrix of 1, x, c_k, dx
    Eigen::MatrixXd errors;              // regressors' errors, a column a channel and the mean
    Eigen::VectorXd squares, undelayed;  // of the errors
    Eigen::VectorXd rest, rest_slope;    // r^2, r^2 dx^2 of what is aligned
    double slope2 = 0, slope4 = 0, count = 0;
    double before = 0, after = 0;
  };
  void add(const Instant& before, const Instant& now, const Instant& after);
  Sums total(std::size_t without) const;
  Eigen::MatrixXd powers(const Sums& sums, Eigen::MatrixXd* loadings) const;

  Eigen::Index n_, axes_;
  std::int64_t batch_, seen_ = 0;
  bool with_truth_;
  Instant last_[2];
  double x0_ = kNoOrigin;
  Eigen::VectorXd c0_;
  std::vector<Sums> batches_;
  static constexpr double kNoOrigin = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace libchar::fusion
