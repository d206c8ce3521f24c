#pragma once
// The document of a characterization (docs/json.md).

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// {"format":"characterization","version":1, …, "fit": {"format":"noise-fit",…}} (docs/json.md).
Json json_report(const Characterization& result);
Json json_report(const CharacterizationView& view);
/// The document without "measured": all that a page shows, and the same bytes for the same characterization.
Json json_without_times(const CharacterizationView& view);
void add_times(Json& document, const Characterization& result);

}  // namespace libchar
