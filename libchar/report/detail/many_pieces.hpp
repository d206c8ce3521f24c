#pragma once
// What the pages of several recordings share (runs of a sensor, a lot of devices).

#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/json.hpp"
#include "libchar/lot/device_record.hpp"

namespace libchar {

/// A recording on such a page: its name, and where its own report is, relative to the page ("" : nowhere).
struct Recorded {
  std::string name, folder;
};

/// The coefficients of a channel for a table: white noise, bias instability, random walk, goodness of fit.
std::vector<std::string> coefficient_cells(const Channel& channel, const NoiseFit* fit);
std::vector<std::string> coefficient_cells(const RecordedChannel& channel);
/// Heads of those cells.
std::vector<std::string> coefficient_heads();
/// What stands below a table of them.
std::string coefficient_note();

/// A row a recording × channel, with links to the reports.
std::string recordings_table(std::span<const Characterization> recordings,
                             const std::vector<Recorded>& names);

/// "White noise 0.0050 deg/s·√s [0.0049, 0.0051]" of a term in its own unit.
std::string with_unit(const Coefficient& c, Term term, const std::string& unit);

/// Input files with their hashes, the command.
std::string many_provenance(std::span<const Characterization> recordings,
                            const std::vector<std::string>& command);

/// {file, sha256, samples, rate_hz, report} of each recording.
Json recordings_json(std::span<const Characterization> recordings,
                     const std::vector<Recorded>& names);

/// The head of a document about them.
Json many_head(const std::string& format,
               std::span<const Characterization> recordings,
               const std::vector<std::string>& command);

/// The page: body within the frame of every page, its numbers in `document`.
std::string many_page(const std::string& title,
                      const std::string& subject,
                      const std::string& body,
                      const Json& document);

}  // namespace libchar
