#pragma once
// Which terms of an alignment pay.

#include "libchar/fusion/alignment_learning.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

struct TermChoice {
  fusion::AlignmentOptions options;            ///< what is kept
  std::vector<AlignmentResult::Trial> trials;  ///< in their order, the first as recorded; empty: nothing could be tried
  bool any() const { return options.delay || options.bias || options.gain || options.misalignment; }
};

/// Tries the terms that `allowed` names one by one, bias first, then delay (by either interpolation), gain, other axes.
/// A term is learnt on one half of the data and judged on the other, in turns; it is kept where it brings the error of
/// the mean or of learnt weights down by the practical tolerance and lets neither grow. With a truth only.
TermChoice choose_terms(const fusion::AlignmentData& data, const fusion::AlignmentOptions& allowed);

}  // namespace libchar
