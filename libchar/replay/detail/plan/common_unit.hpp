#pragma once
// One unit for all sensors of one quantity and their reference.

#include <string>
#include <vector>

#include "libchar/scene/scene.hpp"

namespace libchar {

/// What each sensor's samples (after `scale`) are multiplied by to be in the reference's unit, or without one in that
/// of the first sensor that states one; 1 for a sensor that states none. `units` become those after it. Sensors that
/// see the input with weights of their own (`h`) are left alone: the weights may be what converts.
/// Throws Error(input) where they measure different quantities.
std::vector<double> to_common_unit(const Scene& scene, const std::vector<std::string>& reference_units,
                                   std::vector<std::string>& units);

}  // namespace libchar
