#pragma once
// A lot of devices: what is written, shown and printed of it.
//
//   const FleetLot lot = fleet_lot(records, options);
//   write_fleet_report({.records = records, .lot = &lot, .name = "March"}, folder, force);

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/compare/runs.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {
// All coefficients of a fleet as a table: one row per recording and channel, one column per property, for spreadsheets
// (CSV) and for NumPy (.npz, one array per column). A quantity that no device has, has no column.

/// Gets a file piece by piece.
using TakeBytes = std::function<void(std::string_view)>;

/// In the order of the lot. What is not known is an empty cell.
void write_coefficients_csv(std::span<const DeviceRecord> records, const FleetLot& lot, const TakeBytes& take);

/// The same columns; what is not known is NaN. The status of a quantity is a place in the array `status_words`.
void write_coefficients_npz(std::span<const DeviceRecord> records, const FleetLot& lot, const TakeBytes& take);

struct FleetReport {
  std::span<const DeviceRecord> records;
  const FleetLot* lot = nullptr;
  std::string name;                  ///< of the fleet, in words
  std::vector<std::string> command;  ///< as typed
  /// That the records were made of, one each, where they are still in memory: their Allan curves
  /// are drawn, their logs and settings named.
  std::span<const Characterization> recordings;
  std::vector<std::string> next{};  ///< what to type next: commands
};

/// index.html, coefficients.csv, coefficients.npz and lot.json.
std::vector<std::string> fleet_report_files(const std::filesystem::path& folder);

/// Writes them, all or none; their paths. A hundred thousand devices of six channels are half a gigabyte, nearly all of
/// it the tables, which go to the disk piece by piece. Throws Error(output) as write_outputs does.
std::vector<std::string> write_fleet_report(const FleetReport& report, const std::filesystem::path& folder, bool force);
Json fleet_json(const FleetReport& report);
std::string fleet_html(const FleetReport& report);
/// `worst`: devices named at most.
std::string fleet_text(const FleetReport& report, std::size_t width = 0, std::size_t worst = 20);

// Runs of one sensor, pooled: what is written, shown and printed of them.

/// Runs with what was found of them; `folders` hold the report of each run, relative to the folder of the page ("":
/// none).
struct RunsReport {
  std::span<const Characterization> runs;
  const PooledRuns* pooled = nullptr;
  const LimitReport* limits = nullptr;  ///< of the pooled coefficients; null: none were given
  std::vector<std::string> folders;
  std::vector<std::string> command;
};

/// runs.html, runs.json and CHANNEL.sensor.yaml of the pooled coefficients.
std::vector<OutputFile> runs_files(const RunsReport& report, const std::filesystem::path& folder);
Json runs_json(const RunsReport& report);
std::string runs_html(const RunsReport& report);
std::string runs_text(const RunsReport& report, const TextLook& look = {});

}  // namespace libchar
