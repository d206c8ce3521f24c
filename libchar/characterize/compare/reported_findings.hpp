#pragma once
// What a document says is known of its channels.

#include <vector>

#include "libchar/core/document/schema.hpp"
#include "libchar/core/finding.hpp"

namespace libchar::detail {

/// Subject of what the reader found and a quantity depends on.
inline constexpr const char* kOfRecording = "the recording";

/// Of the report of a characterization, or of what is printed of curves, spectra and fits: all but
/// notes, the worst first; the subject is the channel. None where the document has none.
std::vector<Finding> reported_findings(const MapReader& document);

}  // namespace libchar::detail
