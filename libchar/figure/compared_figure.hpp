#pragma once
// The curves of sensors that are compared, over each other.

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/figure/figure.hpp"

namespace libchar::detail {

/// Allan deviation of the candidates of a group with 95 % bands, and a data sheet's line. Without series where
/// none has a curve.
Chart compared_chart(const ComparedGroup& group);

}  // namespace libchar::detail
