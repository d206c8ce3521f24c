#pragma once
// Limits that both ways of reweighting keep.

namespace libchar::fusion {

/// Variances never reach the denormals, whatever the samples are.
inline constexpr double kTiny = 1e-280;
/// Ratio of standard deviations of 1e13: beyond it the squares tell nothing.
inline constexpr double kSmallestRatio = 1e-26;
/// The falling gain of the start: a = 1 / (k + kStart).
inline constexpr double kStart = 10;

}  // namespace libchar::fusion
