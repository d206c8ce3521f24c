#pragma once
// Takes out of samples what an alignment has learnt of their channels.

#include <Eigen/Core>
#include <vector>

#include "libchar/fusion/alignment.hpp"
#include "libchar/fusion/delay_taps.hpp"

namespace libchar::fusion {

/// The mean over the sensors of each further axis at one instant, saturated samples left out.
void cross_means(const Alignment& alignment, const Eigen::Ref<const Eigen::VectorXd>& column, Eigen::VectorXd& means);

/// Aligned samples with their biases, gains and other axes put back: what the delays alone do.
Eigen::VectorXd in_time(const Alignment& alignment, const Eigen::VectorXd& aligned, const Eigen::VectorXd& cross);

/// Column t of `samples` (as in AlignmentData) aligned: n values. Saturated samples are missing.
class Aligner {
 public:
  explicit Aligner(const Alignment& alignment);
  void column(const Eigen::MatrixXd& samples, Eigen::Index t, Eigen::VectorXd& out) const;
  /// Makes samples at their limits missing.
  void clip(Eigen::MatrixXd& samples) const;

 private:
  const Alignment* alignment_;
  std::vector<DelayTaps> taps_;
};

}  // namespace libchar::fusion
