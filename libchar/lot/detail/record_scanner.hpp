#pragma once
// The fast way to read a device record: one pass over a line as device_record_text writes it, a
// tenth of the time of a tree of the document.

#include <optional>
#include <string_view>

#include "libchar/lot/device_record.hpp"

namespace libchar {

/// Nothing for a line that is anything else: other keys, another order, escapes, blanks, a value out of its range.
/// Whoever asks reads it then as a document, which says what is wrong, if anything is.
std::optional<DeviceRecord> scan_device_record(std::string_view line);

/// The record of any document, as parse_device_record has it.
DeviceRecord read_device_record(std::string_view text, const std::string& path);

}  // namespace libchar
