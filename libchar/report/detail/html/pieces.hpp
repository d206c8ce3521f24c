#pragma once
// What the reports of several recordings share (runs of a sensor, a lot of devices).

#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/lot/device_record.hpp"
#include "libchar/replay/view/replay_view.hpp"
#include "libchar/report/detail/escape.hpp"
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

// The judgement of limits as each output shows it.

/// A section of the page.
std::string limits_section(const LimitReport& report);

// The alignment and the error budget of a replay, in each of its reports; "" without an alignment.

std::string alignment_text(const ReplayView& view, const TextLook& look);
std::string alignment_markdown(const ReplayView& view);
std::string alignment_html(const ReplayView& view);

}  // namespace libchar
