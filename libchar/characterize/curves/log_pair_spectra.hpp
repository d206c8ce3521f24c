#pragma once
// What two channels of a log have in common, and spectra of a log as they change in time.

#include <string>
#include <vector>

#include "libchar/characterize/curves/log_spectra.hpp"
#include "libchar/spectrum/cross_spectrum.hpp"
#include "libchar/spectrum/spectrogram.hpp"

namespace libchar {

struct LogCrossSpectrum {
  LogInfo log;
  Channel first, second;
  CrossSpectrum cross;
};

/// Of the channels `first` and `second`, by name or place (c0 …). Reads these two only. Throws as read_recording and cross_spectrum.
LogCrossSpectrum log_cross_spectrum(const std::string& path,
                                    const std::string& first,
                                    const std::string& second,
                                    const CharacterizeOptions& options,
                                    Progress& progress = no_progress());

struct LogSpectrograms {
  LogInfo log;
  std::vector<Channel> channels;
  std::vector<Spectrogram> spectrograms;  ///< a channel each
};

/// With segments of `options.spectrum.segment` samples or `options.segment_s`. Reads the log whole. Throws as read_recording and spectrogram.
LogSpectrograms log_spectrograms(const std::string& path,
                                 const CharacterizeOptions& options,
                                 Progress& progress = no_progress());

}  // namespace libchar
