#pragma once
// The files of a fleet's report, read back.

#include <filesystem>
#include <vector>

#include "libchar/report/html/fleet_report.hpp"
#include "tests/support/shared.hpp"

namespace test {

inline std::vector<libchar::OutputFile> written_fleet(const libchar::FleetReport& report) {
  const TemporaryFolder folder;
  std::vector<libchar::OutputFile> out;
  for (const std::string& path : libchar::write_fleet_report(report, folder.path() / "report", false))
    out.push_back({std::filesystem::path(path).filename().string(), slurp(path)});
  return out;
}

}  // namespace test
