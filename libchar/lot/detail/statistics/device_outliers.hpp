#pragma once
// Devices of several channels: one that is a little off in all of them stands out as a device where no channel does
// by itself.
//   y_dc = mu_c + a_d + d_dc + e_dc,   a_d ~ N(0, r w²),   d_dc ~ N(0, w²),   e_dc ~ N(0, v_dc) with v_dc known

#include <cstddef>
#include <span>
#include <vector>

#include "libchar/core/numeric/random_effects.hpp"

namespace libchar {

/// The means over the channels held against those of the other devices, as find_outliers does with values; index: the
/// device. `value` and `variance` device by device, `channels` of each, two at least.
std::vector<Outlier> find_device_outliers(std::span<const double> value,
                                          std::span<const double> variance,
                                          std::size_t channels,
                                          double probability);

}  // namespace libchar
