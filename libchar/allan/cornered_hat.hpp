#pragma once
// Deviations of single devices from their differences: the three-cornered hat, and the same for any number of them.

#include <span>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"

namespace libchar {

/// What is known of a device at an averaging time.
enum class HatStatus {
  resolved,      ///< the variance is at least twice its standard deviation
  not_resolved,  ///< positive, but less
  negative,      ///< the others' noise hides it, or the devices are not independent
};

template <>
inline constexpr auto enum_table<HatStatus> =
    enum_words<HatStatus, "resolved not_resolved negative">;

struct HatPoint {
  std::uint64_t m = 0;
  double tau_s = 0;
  double variance = 0;     ///< squared unit of the statistic; may be negative
  double variance_sd = 0;  ///< its standard deviation, for independent devices of white noise
  double deviation = 0;    ///< root of the variance; NaN where that is negative
  std::uint64_t terms = 0;
  HatStatus status = HatStatus::resolved;
};

struct CorneredHat {
  DeviationType type = DeviationType::oadev;
  std::vector<std::vector<HatPoint>> devices;  ///< [device][averaging time]
  std::vector<std::string> notes;
};

/// From n >= 3 records of one length that measure the same at the same time, each with noise of its
/// own: variances of all pairwise differences, then least squares (cornered_hat.cpp). A statistic
/// that is a mean square (all but MTIE, TheoBR and TheoH). Throws Error(usage) for others, fewer
/// than three records, or lengths that differ; as allan_deviation.
CorneredHat cornered_hat(std::span<const std::vector<double>> records,
                         double dt_s,
                         const AllanOptions& options = {});

/// From three records of differences, a - b, b - c, c - a, each measured by itself: the covariances
/// of the two that a device is in, in which the noise of the measurements drops out (Groslambert).
/// Overlapping Allan variance only.
CorneredHat cornered_hat_of_differences(std::span<const std::vector<double>> differences,
                                        double dt_s,
                                        const AllanOptions& options = {});

}  // namespace libchar
