#pragma once
// Recordings that are to be taken together: are they of one sensor?

#include <span>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

/// The channel of that name; null: none.
const ChannelResult* find_channel(const Characterization& result, const std::string& name);

/// Throws Error where the runs cannot be of one sensor (runs.hpp).
void check_runs(std::span<const Characterization> runs);

}  // namespace libchar
