#pragma once
// The power spectra of a log, and the lines in them.

#include <cstdint>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/characterize/characterization.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {

struct LogSpectraOptions {
  ReadOptions reading;  ///< its `threads` serve the spectra too
  /// a segment of 0: a quarter of a record of at most a leaf (2^20 samples), 2^16 samples of a
  /// longer one, as `characterize` does
  WelchOptions spectrum;
  double segment_s = 0;  ///< length of a segment instead of `spectrum.segment`; 0: as that says
  bool quarter_segments = false;  ///< a quarter of a longer record too: the samples are kept
  SegmentAverage average = SegmentAverage::mean;  ///< median: the samples are kept
  bool lines = false;                             ///< find the spectral lines
  std::uint64_t bins =
      0;  ///< average into at most so many on a logarithmic axis of frequency; 0: do not
};

struct ChannelSpectrum {
  Channel channel;
  Spectrum spectrum;
  std::vector<SpectralLine> lines;
  std::vector<Finding> findings = {};  ///< what is known of the samples, the worst first
};

struct LogSpectra {
  LogInfo log;
  std::vector<ChannelSpectrum> channels;  ///< on one axis of frequency; those that give a spectrum
  std::vector<std::string> notes;  ///< "gyro_x: …": of single channels, and why one is missing
};

/// Reads the log once, as it streams, in the memory of a leaf per channel at most; whole where the
/// median or a quarter of a long record is asked for. Throws as read_log and welch, Error(numeric)
/// where the sampling rate is not known or no channel gives a spectrum.
LogSpectra log_spectra(const std::string& path,
                       const LogSpectraOptions& options = {},
                       Progress& progress = no_progress());

/// The same of samples in memory; of `options.reading` only the threads count.
LogSpectra log_spectra(const RecordingView& recording, const LogSpectraOptions& options = {});

// What two channels of a log have in common, and spectra of a log as they change in time.

struct LogCrossSpectrum {
  LogInfo log;
  Channel first, second;
  CrossSpectrum cross;
};

/// Of the channels `first` and `second`, by name or place (c0 …). Reads these two only. Throws as read_recording and cross_spectrum.
LogCrossSpectrum log_cross_spectrum(const std::string& path,
                                    const std::string& first,
                                    const std::string& second,
                                    const LogSpectraOptions& options,
                                    Progress& progress = no_progress());

struct LogSpectrograms {
  LogInfo log;
  std::vector<Channel> channels;
  std::vector<Spectrogram> spectrograms;  ///< a channel each
};

/// With segments of `options.spectrum.segment` samples or `options.segment_s`. Reads the log whole. Throws as read_recording and spectrogram.
LogSpectrograms log_spectrograms(const std::string& path,
                                 const LogSpectraOptions& options,
                                 Progress& progress = no_progress());

// Of the channels of a log: single devices from their differences, and deviations as they change in time.

struct LogAllanOptions {
  ReadOptions reading;
  SampleKind data = SampleKind::rate;
  double nominal_frequency = 0;  ///< as in CharacterizeOptions
  AllanOptions allan;
};

struct LogHat {
  LogInfo log;
  std::vector<Channel> channels;  ///< the devices
  CorneredHat hat;
};

/// Three or more channels that measure the same at once: the deviation of each. `differences`: three channels are a - b, b - c and c - a
/// instead, and the devices are called after them. Reads the log whole. Throws as read_recording and cornered_hat.
LogHat log_cornered_hat(const std::string& path,
                        const LogAllanOptions& options,
                        bool differences,
                        Progress& progress = no_progress());

struct LogDynamic {
  LogInfo log;
  std::vector<Channel> channels;
  std::vector<DynamicDeviation> deviations;  ///< a channel each
};

struct DynamicTimes {
  double window_s = 0, step_s = 0;  ///< step 0: half a window
};

/// Reads the log whole. Throws as read_recording and dynamic_deviation.
LogDynamic log_dynamic_deviation(const std::string& path,
                                 const LogAllanOptions& options,
                                 const DynamicTimes& times,
                                 Progress& progress = no_progress());

}  // namespace libchar
