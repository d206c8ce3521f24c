#pragma once
// What no number of samples tells without a reference: errors that all sensors share.

#include <cmath>
#include <optional>

namespace libchar::detail {

/// By what the sensors differ from each other; empty: there is a reference, or too little is seen.
struct CommonErrors {
  std::optional<double> level_sd;    ///< deviation of the level, by what the sensors' means differ
  std::optional<double> gain_sd;     ///< of the gain that all share, by what the sensors' gains differ
  std::optional<double> gain_about;  ///< input at which that does not matter
  /// The deviation `sd` of an estimate `x`, with these.
  double with_common(double sd, double x) const {
    return std::hypot(sd, level_sd.value_or(0), gain_sd.value_or(0) * (x - gain_about.value_or(0)));
  }
};

}  // namespace libchar::detail
