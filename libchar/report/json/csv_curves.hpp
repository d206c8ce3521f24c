#pragma once
// The curves of a characterization as one table.

#include <string>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// Allan and spectrum curves of all channels in one table: curve,channel,unit,x,x_unit,value,low68,high68,low95,high95,dof,terms,model,model_low95,model_high95.
std::string csv_curves(const CharacterizationView& view);
std::string csv_curves(const Characterization& result);

}  // namespace libchar
