#pragma once
// Differences between sensors of one quantity other than noise, learned from a stretch of their samples.

#include <Eigen/Core>
#include <vector>

#include "libchar/fusion/alignment.hpp"

namespace libchar::fusion {

struct AlignmentOptions {
  bool delay = true, bias = true, gain = true, misalignment = true;
  Interpolation interpolation = Interpolation::sinc;
};

/// What is learnt from: rows of consecutive instants, in one or several stretches.
struct AlignmentData {
  /// n rows of one quantity, then n rows a further axis (the same sensors in the same order).
  Eigen::MatrixXd samples;
  Eigen::Index channels = 0;
  Eigen::RowVectorXd truth;          ///< empty: blind, the mean of the channels is the truth
  std::vector<Eigen::Index> starts;  ///< first column of each stretch
};

/// Instants that the interpolation looks at on either side, for delays of at most 8 samples or those of an alignment.
inline constexpr Eigen::Index kAlignmentMargin = 21;
Eigen::Index margin_of(const Alignment& alignment);

/// Blind: sum of delays, of biases and of gains zero. Throws Error(numeric) when fewer than two
/// channels (with a truth: one) have samples, or when there are fewer than 64 instants.
Alignment learn_alignment(const AlignmentData& data, const AlignmentOptions& options);

}  // namespace libchar::fusion
