#pragma once
// Noise coefficients of the curves of a table: read off a data sheet, or computed elsewhere.

#include <optional>
#include <string>
#include <vector>

#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/log/read.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

struct CurveTableOptions {
  bool is_allan = true;      ///< deviations over s; else spectral densities over Hz
  Sides sides = Sides::one;  ///< of spectral densities
  std::optional<bool>
      root;  ///< values are roots (deviation, U/√Hz); unset: by the header, else deviations are, densities are not
  std::optional<double> duration_s;  ///< of the record behind an Allan curve: gives honest intervals
  ReadOptions reading;               ///< its channels, units and rate, and what a table of numbers needs
  FitOptions fit;
};

struct ChannelFit {
  Channel channel;
  NoiseFit fit;
};

struct CurveTableFit {
  LogInfo table;  ///< file, size, hash
  std::vector<ChannelFit> channels;
};

/// Reads a table whose header names its curves, or one whose first column is the averaging time or the frequency and
/// whose others are curves, and fits each. Throws as read_log and fit_curve, Error(input) for fewer than two columns,
/// Error(usage) where no curve has the names wanted.
CurveTableFit fit_curve_table(const std::string& path, const CurveTableOptions& options = {},
                              Progress& progress = no_progress());

}  // namespace libchar
