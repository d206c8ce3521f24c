#pragma once
// Allan curves as a table and as a document (docs/json.md).

#include <vector>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// channel,unit,tau_s,deviation,low68,high68,low95,high95,edf,terms,curve: a row a point.
std::string allan_csv(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves);

/// Channel by channel, without models.
Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves);

}  // namespace libchar
