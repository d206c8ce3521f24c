#pragma once
// The power spectra of a log on one axis of frequency, and the lines in them.

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

struct LogSpectra {
  LogInfo log;
  std::vector<ChannelResult> channels;  ///< those that give a spectrum
  std::vector<std::string> notes;  ///< "gyro_x: …": of single channels, and why one is missing
};

/// `characterize` of spectra alone, lines where `wanted.lines` asks for them. Of the options `reading` (its threads
/// serve the spectra too), `data`, what counts as missing, and those of the spectrum have an effect. Without a segment
/// all channels of one rate get the shortest that one of them needs. Throws as characterize, Error(numeric) where the
/// sampling rate is not known or no channel gives a spectrum.
LogSpectra log_spectra(const std::string& path,
                       const CharacterizeOptions& options = {},
                       Progress& progress = no_progress());
LogSpectra log_spectra(const RecordingView& recording, const CharacterizeOptions& options = {});

}  // namespace libchar
