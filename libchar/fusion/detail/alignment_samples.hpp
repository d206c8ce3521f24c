#pragma once
// Samples fit to learn an alignment from: without those at a limit of the range, without wild ones.

#include <Eigen/Core>

#include "libchar/fusion/alignment.hpp"

namespace libchar::fusion {

/// A limit is an extreme value that stands there at least three times, twice in a row, and three
/// times as often as the next value: a saturated sensor, and no tail of a distribution.
ChannelLimits limits_of(const Eigen::Ref<const Eigen::VectorXd>& samples);

/// Makes missing, stretch by stretch of 512 instants, what is more than ten times as far from the
/// median of all channels as the others of its own channel are there (their root mean square
/// without the largest hundredth). `samples`: a column a channel.
void drop_wild(Eigen::Ref<Eigen::MatrixXd> samples);

/// Each column through a low-pass (49 taps of a windowed sinc, 0.1 of the rate); missing samples are
/// left out of the sums, a sample with less than half of the weight present is missing.
Eigen::MatrixXd low_passed(const Eigen::Ref<const Eigen::MatrixXd>& samples);

}  // namespace libchar::fusion
