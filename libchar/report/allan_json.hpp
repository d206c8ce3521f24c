#pragma once
// Allan curves as a document (docs/json.md).

#include <vector>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// Channel by channel, without models.
Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves);

}  // namespace libchar
