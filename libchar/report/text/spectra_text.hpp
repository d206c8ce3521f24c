#pragma once
// The spectra of a log as tables and as a document (docs/json.md).

#include <string>

#include "libchar/characterize/curves/log_spectra.hpp"
#include "libchar/core/document/json.hpp"

namespace libchar {

/// frequency_hz and a column a channel.
std::string spectra_csv(const LogSpectra& spectra);
/// channel,unit,frequency_hz,amplitude,excess,width_hz: a row a line.
std::string lines_csv(const LogSpectra& spectra);
/// Without the head of a document; lines where they were asked for.
Json spectra_json(const LogSpectra& spectra, const LogSpectraOptions& options);

}  // namespace libchar
