#pragma once
// What a unit is expected to take, from measurements of this machine:
//   seconds = fixed * channels + sample * samples * channels + byte * bytes of text
// `fixed` and `sample` from characterizing two simulated records in memory, `byte` from reading a simulated CSV file.

#include "libchar/fleet/unit.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

struct CostModel {
  double fixed_s = 0;        ///< a channel's fit and its part of the report
  double sample_s = 0;       ///< a sample's curve and spectrum
  double text_byte_s = 0;    ///< reading and hashing a byte of a text log
  double binary_byte_s = 0;  ///< the same of a binary log

  UnitCost of(const FleetUnit& unit, const LogInfo& head) const;
};

/// Measures, about a second.
CostModel measured_cost();

}  // namespace libchar
