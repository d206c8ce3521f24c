#pragma once
// A fleet of small logs in a folder of its own.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "libchar/fleet/plan.hpp"
#include "libchar/fleet/run_unit.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/shared.hpp"

namespace test {

inline void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// DIR/d0.csv …: two channels of noise at 100 Hz, other numbers in each.
inline std::vector<std::string> write_logs(const std::filesystem::path& folder,
                                           std::size_t count,
                                           std::size_t rows = 600) {
  std::vector<std::string> logs;
  for (std::size_t d = 0; d < count; ++d) {
    Gaussian gauss(d + 1);
    std::string text = "t[s],gx[deg/s],gy[deg/s]\n";
    for (std::size_t k = 0; k < rows; ++k)
      text +=
          fmt::format("{:.2f},{:.6f},{:.6f}\n", static_cast<double>(k) / 100, gauss(), 2 * gauss());
    logs.push_back((folder / fmt::format("d{}.csv", d)).string());
    write_file(logs.back(), text);
  }
  return logs;
}

inline libchar::FleetPlan planned(const std::vector<std::string>& logs,
                                  const libchar::FleetPlanOptions& options = {}) {
  return libchar::plan_fleet(libchar::manifest_of_logs(logs), options);
}

inline void run_all(const libchar::FleetPlan& plan, const std::filesystem::path& fleet) {
  for (const libchar::FleetUnit& unit : plan.units) libchar::run_unit(unit, fleet);
}

}  // namespace test
