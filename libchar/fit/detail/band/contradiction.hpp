#pragma once
// Where the record itself speaks against a fitted coefficient.

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

/// Compares the fit with the measured Allan curve and with the second opinion. A coefficient that they contradict by
/// more than chance and by more than a fifth becomes `undetermined`, and a sentence says what speaks against it.
void answer_contradictions(NoiseFit& fit, const AllanCurve& allan);

}  // namespace libchar
