#pragma once
// Where the sensors of an array have samples, and which of them stands still where the others move.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace libchar {

/// Where a channel has samples.
struct Presence {
  std::uint64_t first = 0, last = 0, samples = 0;  ///< grid points; samples 0: nowhere
  std::uint64_t still_from = 0, still = 0;         ///< its longest run of one value
  std::uint64_t run = 0;                           ///< of the last value
  double value = 0;                                ///< the last one

  /// Consecutive samples, the first of them at a grid point.
  void push(std::uint64_t at, std::span<const double> values);
};

/// One that stands still for long between two grid points, as no other of three or more does: a noise
/// never gives one value so often, and a quantity that rests between coarse steps does so for all.
bool is_frozen(std::span<const Presence> presence, std::size_t i, double from, double to);

/// "NAME from 120 to 240 s".
std::string still_words(const std::string& name, const Presence& at, double rate_hz);

}  // namespace libchar
