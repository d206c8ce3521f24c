#pragma once
// What the mean and the spread of those counted say of all devices of a lot, those not detected or doubtful among them.

#include <optional>
#include <span>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/random_effects.hpp"
#include "libchar/lot/device_quantity.hpp"

namespace libchar {

struct LotCounts;

struct LeftOut {
  double share = 0;  ///< of the devices that have a result: not detected or doubtful
  Interval
      mean_ci95;  ///< of all of them, in the unit of the values: holds what is possible whichever they are
  /// The mean of those counted is off by this factor at most: too large, of a temperature coefficient too far from zero.
  double factor = 1;
  double spread_high = 0;  ///< upper end of the spread of all; NaN of a temperature coefficient
};

/// Nothing where all count, and of quantities that are not left out for being small.
std::optional<LeftOut> left_out(DeviceQuantity quantity,
                                const LotCounts& counts,
                                std::span<const double> value,
                                std::span<const double> variance,
                                const RandomEffects& effects);

}  // namespace libchar
