#pragma once
// An interval of numbers.

namespace libchar {

struct Interval {
  double low = 0, high = 0;
  bool operator==(const Interval&) const = default;
};

/// A standard normal value lies within this of zero with 95 %.
inline constexpr double kNormal95 = 1.959963984540054;

}  // namespace libchar
