#pragma once
// Expected squared DCT-II coefficients of a series of means, at every k.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Of each term for theta = 1, k = 1..n-1 at [k-1], of n plain means of m samples at dt_s (BlockMeanDct is of sqrt(m)
/// times the mean and exact, at the price of two transforms; this one is good to .2 %).
std::array<double, kTerms> mean_unit_powers(double k, std::uint64_t n, std::uint64_t m, double dt_s);

/// `count` functions that are smooth beyond the lowest coefficients, each at every k = 1..n-1: called where k <= 64 and
/// sixteen times an octave, joined by straight lines. `power` writes their values at a k.
std::vector<std::vector<double>> at_every_k(std::size_t n, std::size_t count,
                                            const std::function<void(double, std::span<double>)>& power);

/// Beyond the lowest 256 coefficients a stretch of a sixth of k, 64 and more, from..to-1 (indices k-1), has a level of
/// its own.
struct LevelStretch {
  std::size_t from = 0, to = 0;
};
std::vector<LevelStretch> level_stretches(std::size_t coefficients);

/// -2 ln L of coefficients that are normal with mean zero and these expected squares, but for a constant. The level of
/// every stretch is free: how strong a line, a hump or a filter's slope is says nothing about events.
double deviance_of(std::span<const double> coefficients, std::span<const double> power);

/// The powers raised to what the coefficients show over a stretch, wherever that is more by more than chance: a line or
/// a hump that the noise does not describe shall not look like an event.
void raise_to_measured(std::span<const double> coefficients, std::vector<double>& power);

}  // namespace libchar
