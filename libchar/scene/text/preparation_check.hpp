#pragma once
// Whether the filter, the trend and the offset of a scene go together.

#include <string>

#include "libchar/scene/scene.hpp"

namespace libchar {

/// Why this scene cannot be prepared as it says, a sentence; empty: it can. The rate is not known here.
std::string why_not_prepared(const Scene& scene);

}  // namespace libchar
