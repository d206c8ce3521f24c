#pragma once
// A lot of devices: what is written, shown and printed of it.
//
//   const FleetLot lot = fleet_lot(records, options);
//   write_fleet_report({.records = records, .lot = &lot, .name = "March"}, folder, force);

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

struct FleetReport {
  std::span<const DeviceRecord> records;
  const FleetLot* lot = nullptr;
  std::string name;                  ///< of the fleet, in words
  std::vector<std::string> command;  ///< as typed
  /// That the records were made of, one each, where they are still in memory: their Allan curves
  /// are drawn, their logs and settings named.
  std::span<const Characterization> recordings;
};

/// index.html, coefficients.csv, coefficients.npz and lot.json.
std::vector<std::string> fleet_report_files(const std::filesystem::path& folder);

/// Writes them, all or none; their paths. A hundred thousand devices of six channels are half a
/// gigabyte, nearly all of it the tables, which go to the disk piece by piece. Throws Error(output)
/// as write_outputs does.
std::vector<std::string> write_fleet_report(const FleetReport& report,
                                            const std::filesystem::path& folder,
                                            bool force);
Json fleet_json(const FleetReport& report);
std::string fleet_html(const FleetReport& report);
/// `worst`: devices named at most.
std::string fleet_text(const FleetReport& report, std::size_t width = 0, std::size_t worst = 20);

}  // namespace libchar
