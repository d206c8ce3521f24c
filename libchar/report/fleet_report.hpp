#pragma once
// A fleet's lot: what is written, shown and printed of it.
//
//   const FleetLot lot = fleet_lot(records, options);
//   write_fleet_report({.records = records, .lot = &lot, .name = "March"}, folder, force);

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/json.hpp"
#include "libchar/core/output_files.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

struct FleetReport {
  std::span<const DeviceRecord> records;
  const FleetLot* lot = nullptr;
  std::string name;                  ///< of the fleet, in words
  std::vector<std::string> command;  ///< as typed
  std::vector<LogInfo>
      inputs;  ///< small files that it was made from (document_info): limits, a plan
};

/// index.html, coefficients.csv, coefficients.npz and lot.json, all of them or none; their paths. A hundred thousand devices of six channels
/// are half a gigabyte, nearly all of it the tables, which go to the disk piece by piece. Throws Error(output) as write_outputs does.
std::vector<std::string> write_fleet_report(const FleetReport& report,
                                            const std::filesystem::path& folder,
                                            bool force);
Json fleet_json(const FleetReport& report);
std::string fleet_html(const FleetReport& report);
/// `worst`: devices named at most.
std::string fleet_text(const FleetReport& report, std::size_t width = 0, std::size_t worst = 20);

}  // namespace libchar
