#pragma once
// Which number goes where: the same coefficients in the units and under the names of the programs
// and papers that ask for them (docs/exports.md). Only N, K and B are exchanged;
// everything else follows by the formula shown. The rows: detail/consumer_rows.hpp.

#include <string>
#include <vector>

#include "libchar/core/coefficient.hpp"

namespace libchar {

struct ConsumerNumber {
  std::string consumer;  ///< "Kalibr, EuRoC, OpenVINS"
  std::string key;       ///< "gyroscope_noise_density"
  std::string formula;   ///< "N"
  std::string value;     ///< to be read, "≤" in front when it is an upper limit
  std::string unit;
};

/// Rows for a channel of known quantity; for other channels those that need no convention. Empty
/// without white noise.
std::vector<ConsumerNumber> consumer_numbers(const Coefficients& coefficients,
                                             const std::string& unit,
                                             double rate_hz);

}  // namespace libchar
