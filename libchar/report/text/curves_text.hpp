#pragma once
// Allan curves as a table and as a document (docs/json.md).

#include <string>
#include <vector>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/curves/log_spectra.hpp"
#include "libchar/characterize/log_devices.hpp"
#include "libchar/core/document/json.hpp"

namespace libchar {

/// channel,unit,tau_s,deviation,low68,high68,low95,high95,edf,terms,curve,findings: one row per point; bounds and edf
/// empty where there is no interval. A channel has an entry in both lists for each of its curves; `findings` of each
/// curve, none where it is shorter, and those of the recording: cautions and bad ones as "motion:bad event:caution".
std::string allan_csv(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves,
                      const std::vector<std::vector<Finding>>& findings = {}, const Findings& recording = {});

/// Channel by channel, without models; where there are several types, `types` and the `type` of each entry.
/// `findings`: of each channel, none where it is shorter.
Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves,
                const std::vector<std::vector<Finding>>& findings = {});

// The spectra of a log as tables and as a document (docs/json.md).

/// frequency_hz and one column per channel. Where something is known of one, a last column `findings`, in whose first
/// row they are by channel: "motion:bad|event:caution".
std::string spectra_csv(const LogSpectra& spectra);
/// channel,unit,frequency_hz,amplitude,excess,width_hz: one row per line.
std::string lines_csv(const LogSpectra& spectra);
/// Without the head of a document; lines where they were asked for.
Json spectra_json(const LogSpectra& spectra, const CharacterizeOptions& options);

// Cornered hats and dynamic deviations as tables and documents (docs/json.md).

/// channel,unit,tau_s,deviation,variance,variance_sd,status,terms: one row per device and averaging time; no deviation
/// where the variance is negative.
std::string hat_csv(const LogHat& hat);
Json hat_json(const LogHat& hat);

/// channel,unit,time_s,from_s,to_s,tau_s,deviation,terms: a row a window and averaging time; `time_s` is the window's
/// middle.
std::string dynamic_csv(const LogDynamic& dynamic);
Json dynamic_json(const LogDynamic& dynamic);

// Cross spectra, coherences and spectrograms as tables and documents (docs/json.md).

/// frequency_hz,real,imaginary,magnitude,phase_rad,phase_sd_rad,FIRST,SECOND,coherence,coherence_unbiased; units in the
/// heads.
std::string cross_csv(const LogCrossSpectrum& cross);
/// frequency_hz,coherence,coherence_unbiased,significant: the last whether independent channels stay below with 95 %.
std::string coherence_csv(const LogCrossSpectrum& cross);
Json cross_json(const LogCrossSpectrum& cross);

/// channel,unit,time_s,frequency_hz,value: a row a segment and bin.
std::string spectrograms_csv(const LogSpectrograms& spectrograms);
Json spectrograms_json(const LogSpectrograms& spectrograms);

// The curves of a characterization as one table.

/// Allan and spectrum curves of all channels in one table:
/// curve,channel,unit,x,x_unit,value,low68,high68,low95,high95,dof,terms,model,model_low95,model_high95,findings.
std::string csv_curves(const CharacterizationView& view);
std::string csv_curves(const Characterization& result);

}  // namespace libchar
