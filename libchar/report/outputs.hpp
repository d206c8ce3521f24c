#pragma once
// The files of a characterization, as text: whoever calls writes them (whole_file.hpp).

#include <string>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// One self-contained page: no network, opens from disk. The same bytes for the same characterization.
std::string html_report(const Characterization& result);
/// The same where its view and its document are there already.
std::string html_report(const CharacterizationView& view, const Json& without_times);

/// {"format":"characterization","version":1, …, "fit": {"format":"noise-fit",…}} (docs/json.md).
Json json_report(const Characterization& result);
Json json_report(const CharacterizationView& view);
/// The document without "measured": all that a page shows, and the same bytes for the same characterization.
Json json_without_times(const CharacterizationView& view);
void add_times(Json& document, const Characterization& result);

/// Allan and spectrum curves of all channels in one table: curve,channel,unit,x,x_unit,value,low68,high68,low95,high95,dof,terms,model.
std::string csv_curves(const CharacterizationView& view);
std::string csv_curves(const Characterization& result);

/// The pieces of JSON that the verbs share (keys: docs/json.md).
Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves);

}  // namespace libchar
