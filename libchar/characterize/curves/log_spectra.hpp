#pragma once
// The power spectra of a log on one axis of frequency, and the lines in them.

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

struct LogSpectra {
  LogInfo log;
  std::vector<ChannelResult> channels;  ///< those that give a spectrum
  std::vector<std::string> notes;       ///< "gyro_x: …": of single channels, and why one is missing
};

/// `characterize` of spectra alone, lines where `wanted.lines` asks for them. Of the options `reading` (its threads
/// serve the spectra too), `data`, what counts as missing, and those of the spectrum have an effect. Without a segment
/// all channels of one rate get the shortest that one of them needs. Throws as characterize, Error(numeric) where the
/// sampling rate is not known or no channel gives a spectrum.
LogSpectra log_spectra(const std::string& path, const CharacterizeOptions& options = {},
                       Progress& progress = no_progress());
LogSpectra log_spectra(const RecordingView& recording, const CharacterizeOptions& options = {});

// What two channels of a log have in common, and spectra of a log as they change in time.

struct LogCrossSpectrum {
  LogInfo log;
  Channel first, second;
  CrossSpectrum cross;
};

/// Of the channels `first` and `second`, by name or place (c0 …). Reads these two only. Throws as read_recording and
/// cross_spectrum.
LogCrossSpectrum log_cross_spectrum(const std::string& path, const std::string& first, const std::string& second,
                                    const CharacterizeOptions& options, Progress& progress = no_progress());

struct LogSpectrograms {
  LogInfo log;
  std::vector<Channel> channels;
  std::vector<Spectrogram> spectrograms;  ///< a channel each
};

/// With segments of `options.spectrum.segment` samples or `options.segment_s`. Reads the log whole. Throws as
/// read_recording and spectrogram.
LogSpectrograms log_spectrograms(const std::string& path, const CharacterizeOptions& options,
                                 Progress& progress = no_progress());

}  // namespace libchar
