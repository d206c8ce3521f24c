#pragma once
// The effective settings of a characterization, as a report records them.

#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/document/fields.hpp"

namespace libchar {

/// The keys of `config` in report.json.
const Fields<CharacterizeOptions>& characterize_fields();

/// Every setting with its value.
std::vector<Entry> settings_of(const CharacterizeOptions& options);

}  // namespace libchar
