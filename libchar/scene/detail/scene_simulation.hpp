#pragma once
// The block `simulate` of a scene file.

#include <string>
#include <vector>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_paths.hpp"
#include "libchar/simulate/signal.hpp"

namespace libchar {

// The description of a true signal in a scene or beside it.

/// One signal: a map {kind, …} with the keys of its kind; a bare word is a kind, a bare number a
/// constant. `earlier` names the signals that stand before it (`of` may be such a name or an index
/// from 0). Samples of kind recording are left unread.
SignalSpec read_signal(const Document& node,
                       const std::string& file,
                       const std::string& path,
                       const std::vector<std::string>& earlier = {});

/// The block `simulate`, without sensors and faults.
ArraySimulation scene_simulation_of(const MapReader& top, const SceneFolder& folder, Scene& scene);

}  // namespace libchar
