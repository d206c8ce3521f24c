#pragma once
// What the reports of several recordings share (runs of a sensor, a lot of devices).

#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/lot/device_record.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"

namespace libchar {

/// A table of channels, its first column the name of what they are recorded in.
Table channels_table(const char* recordings);
/// A row a channel.
void add_channels(Table& table, const DeviceRecord& record, const std::string& name);

/// The name, with a link to the page in that folder, relative to this one ("": none).
Cell report_cell(const std::string& name, const std::string& folder);

/// Input files with their hashes, where they are in memory; the command.
std::string many_provenance(std::span<const Characterization> recordings,
                            const std::vector<std::string>& command);

/// The head of a document about them, with their settings.
Json many_head(const std::string& format,
               std::span<const Characterization> recordings,
               const std::vector<std::string>& command);

}  // namespace libchar
