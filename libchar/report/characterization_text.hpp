#pragma once
#include <string>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// A characterization in text, for a terminal: the recording in a line, then each channel's fit, what
/// a verification found, and why something is absent.
std::string characterization_text(const CharacterizationView& view, std::size_t width = 0);
std::string characterization_text(const Characterization& result, std::size_t width = 0);

}  // namespace libchar
