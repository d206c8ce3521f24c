#pragma once
// Cross spectra, coherences and spectrograms as tables and documents (docs/json.md).

#include <string>

#include "libchar/characterize/curves/log_pair_spectra.hpp"
#include "libchar/core/document/json.hpp"

namespace libchar {

/// frequency_hz,real,imaginary,magnitude,phase_rad,phase_sd_rad,FIRST,SECOND,coherence,coherence_unbiased; units in the heads.
std::string cross_csv(const LogCrossSpectrum& cross);
/// frequency_hz,coherence,coherence_unbiased,significant: the last whether independent channels stay below with 95 %.
std::string coherence_csv(const LogCrossSpectrum& cross);
Json cross_json(const LogCrossSpectrum& cross);

/// channel,unit,time_s,frequency_hz,value: a row a segment and bin.
std::string spectrograms_csv(const LogSpectrograms& spectrograms);
Json spectrograms_json(const LogSpectrograms& spectrograms);

}  // namespace libchar
