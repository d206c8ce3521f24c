#pragma once
// Allan curves as a table and as a document (docs/json.md).

#include <vector>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// channel,unit,tau_s,deviation,low68,high68,low95,high95,edf,terms,curve: a row a point; bounds and edf empty where there is no interval.
/// A channel has an entry in both lists for each of its curves.
std::string allan_csv(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves);

/// Channel by channel, without models; where there are several types, `types` and the `type` of each entry.
Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves);

}  // namespace libchar
