#pragma once
// allan --plot and psd --plot: curves in the terminal.

#include <span>
#include <string>

#include "libchar/figure/figure_source.hpp"

namespace sensorchar {

/// A figure for each unit of the channels, as wide as the terminal (else 80 characters), in colour where --color
/// and the terminal say so.
std::string terminal_plots(std::span<const libchar::SourceCurve> curves);

}  // namespace sensorchar
