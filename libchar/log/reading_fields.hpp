#pragma once
// The reading options as keys: of a scene's recording, and of the settings that a report records.

#include "libchar/core/document/fields.hpp"
#include "libchar/log/read.hpp"

namespace libchar {

/// Sampling rates that are read and simulated, in Hz.
inline constexpr NumberRange kRates{1e-9, 1e12, false};

/// How the samples of a file are to be read; threads, block size and hash change no result and have no key.
const Fields<ReadOptions>& reading_fields();

/// The keys with values other than their default.
std::vector<std::string> options_given(const ReadOptions& options);

}  // namespace libchar
