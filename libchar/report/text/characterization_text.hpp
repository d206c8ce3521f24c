#pragma once
#include <string>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {

/// A characterization in text, for a terminal: the recording in a line, then each channel's fit, what
/// a verification found, and why something is absent.
std::string characterization_text(const CharacterizationView& view, const TextLook& look = {});
std::string characterization_text(const Characterization& result, const TextLook& look = {});

}  // namespace libchar
