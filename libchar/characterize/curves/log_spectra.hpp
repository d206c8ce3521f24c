#pragma once
// The power spectra of a log, and the lines in them.

#include <cstdint>
#include <string>
#include <vector>

#include "libchar/log/read.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/spectrum/lines.hpp"
#include "libchar/spectrum/median_spectrum.hpp"
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

}  // namespace libchar
