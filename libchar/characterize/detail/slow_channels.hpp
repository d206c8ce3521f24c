#pragma once
// A channel that is slower than the rows of its table has a clock of its own: blanks between its samples are
// no missing samples.

#include <string>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

/// Reads the slow channels of a log again, each alone on its own grid, and puts what they give in the place
/// of what they gave in the grid of the table. Where the log cannot be read twice, or a temperature binds the
/// channels together, a finding says so.
void read_slow_channels_alone(const std::string& path,
                              const CharacterizeOptions& options,
                              Characterization& result,
                              Progress& progress);

}  // namespace libchar
