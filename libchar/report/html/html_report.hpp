#pragma once
// The page of a characterization, as text: whoever calls writes it (whole_file.hpp).

#include <string>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// One self-contained page: no network, opens from disk. The same bytes for the same characterization.
std::string html_report(const Characterization& result);
/// The same where its view and its document are there already.
std::string html_report(const CharacterizationView& view, const Json& without_times);

}  // namespace libchar
