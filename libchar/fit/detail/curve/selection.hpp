#pragma once
// Intervals of a coefficient that is reported because its likelihood ratio passed a threshold.

namespace libchar {

/// Rise of -2 ln L at which the lower 95 % limit of a term stands when it is reported only above `threshold` and was
/// found with `likelihood_ratio`: above the chi-square quantile 3.84, which it approaches far from the threshold.
/// Where it exceeds the likelihood ratio itself, the interval begins at zero.
double selected_rise(double likelihood_ratio, double threshold);

}  // namespace libchar
