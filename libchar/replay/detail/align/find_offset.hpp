#pragma once
// By how much the reference reads more than the sensors.

#include "libchar/replay/detail/align/instants.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// Mean of (truth - what the sensors say) over instants [from, to), with a 95 % interval whatever
/// the correlation of the difference; as fused (a tilt in rad). Sensors say the least squares of
/// those that are there; of a tilt the angle of gravity. One pass, constant memory. Throws
/// Error(input) for several true inputs, and where fewer than two instants have both.
struct OffsetEstimate {
  double offset = 0, reach95 = 0;
  bool long_memory = false;  ///< the difference drifts within the stretch
};
OffsetEstimate find_reference_offset(const Scene& scene,
                                     const Instants& instants,
                                     std::int64_t from,
                                     std::int64_t to,
                                     Progress& progress);

}  // namespace libchar
