#pragma once
// Cost against error: which methods nobody beats in both.

#include <vector>

namespace libchar {

struct CostAndError {
  double cost = 0, error = 0;  ///< NaN in either: does not take part
};

/// How far each is from the front: its error over the least error of any that costs no more, minus
/// one. 0: it is on the front. NaN: it does not take part.
std::vector<double> front_gaps(const std::vector<CostAndError>& points);

}  // namespace libchar
