#pragma once
// How well the devices of a lot keep a limit.

#include <optional>
#include <string>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/random_effects.hpp"

namespace libchar {

struct Capability {
  double most = 0;   ///< the limit, in the unit of the values
  std::string text;  ///< as its file says it
  std::size_t pass = 0, fail = 0,
              not_decided = 0;  ///< devices; each by the interval of its own value
  /// (limit - mean) / (3 spread) in logarithms, by the devices' own mean and spread; infinite: no spread is seen
  std::optional<double> ppk;
  Interval ppk_ci95;
  /// The same with the deviation from one device to the next of the control chart, which holds the uncertainty of each as well.
  std::optional<double> cpk;
  double above =
      0;  ///< share of devices above the limit that a normal distribution with that ppk has
};

/// Fills ppk, its interval and `above`. `limit` as what `effects` is of.
void add_ppk(const RandomEffects& effects, double limit, Capability& out);

}  // namespace libchar
