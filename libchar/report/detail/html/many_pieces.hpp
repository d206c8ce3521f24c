#pragma once
// What the reports of several recordings share (runs of a sensor, a lot of devices).

#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/lot/device_record.hpp"
#include "libchar/report/detail/svg/svg_curves.hpp"

namespace libchar {

/// The coefficients of a channel for a table: white noise, bias instability, random walk, goodness of fit.
std::vector<std::string> coefficient_cells(const Channel& channel, const NoiseFit& fit);
/// Heads of those cells.
std::vector<std::string> coefficient_heads();

struct ChannelRow {
  std::string recording,
      report;  ///< what it is called, and the folder of its own page, relative to this one ("": none)
  std::string channel;
  std::vector<std::string> cells;  ///< under coefficient_heads
};

/// One row per channel.
std::vector<ChannelRow> channel_rows(const DeviceRecord& record, const std::string& name);

/// The name, with a link to the page in that folder where there is one.
std::string report_link(const std::string& name, const std::string& folder);

/// `recordings`: the head of their names.
std::string channels_table(const std::string& recordings, const std::vector<ChannelRow>& rows);

/// The points of the curve that can be relied on, times a factor.
SvgCurve allan_svg(const AllanCurve& allan, double factor = 1);

/// Input files with their hashes, where they are in memory; the command.
std::string many_provenance(std::span<const Characterization> recordings,
                            const std::vector<std::string>& command);

/// The head of a document about them, with their settings.
Json many_head(const std::string& format,
               std::span<const Characterization> recordings,
               const std::vector<std::string>& command);

}  // namespace libchar
