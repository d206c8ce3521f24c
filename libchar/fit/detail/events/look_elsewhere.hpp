#pragma once
// How large the largest of many correlated normal scores is by chance.

#include <cstddef>
#include <span>

namespace libchar {

/// P(Z > u) of a standard normal, and its density.
double normal_tail(double u);
double normal_density(double u);

/// The u that the largest |score| of a chain of standard normal scores passes with probability `alpha`. `distance[i]` is the
/// standard deviation of score i+1 less score i.
///   rough:  the scores move like a random walk from one to the next (places of a step); every distance stands for `each`
///   smooth: they lie on a smooth curve (time constants of a drift)
double rough_threshold(std::span<const double> distance, double alpha, double each = 1);
double smooth_threshold(std::span<const double> distance, double alpha);

}  // namespace libchar
