#pragma once
// Do two lots scatter alike?

#include <span>

namespace libchar {

/// Probability of spreads that differ as much where they are equal; 1 of fewer than four values on
/// a side.
double equal_spread_p(std::span<const double> y_a,
                      std::span<const double> v_a,
                      std::span<const double> y_b,
                      std::span<const double> v_b);

}  // namespace libchar
