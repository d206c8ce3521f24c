#pragma once
// A fleet of small logs in a folder of its own.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "libchar/fleet/plan.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/shared.hpp"

namespace test {

inline void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// DIR/d0.csv …: two channels of noise at 100 Hz, other numbers in each.
inline std::vector<std::string> write_logs(const std::filesystem::path& folder, std::size_t count,
                                           std::size_t rows = 600) {
  std::vector<std::string> logs;
  for (std::size_t d = 0; d < count; ++d) {
    Gaussian gauss(d + 1);
    std::string text = "t[s],gx[deg/s],gy[deg/s]\n";
    for (std::size_t k = 0; k < rows; ++k)
      text += fmt::format("{:.2f},{:.6f},{:.6f}\n", static_cast<double>(k) / 100, gauss(), 2 * gauss());
    logs.push_back((folder / fmt::format("d{}.csv", d)).string());
    write_file(logs.back(), text);
  }
  return logs;
}

/// Rows of channels c0, c1… of float64 in numpy's format; noise, another one in each channel.
inline std::string write_rows(const std::filesystem::path& path, std::size_t channels, std::size_t rows) {
  std::string head = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}), }}", rows, channels);
  head.resize(117, ' ');
  head += '\n';
  std::string bytes("\x93NUMPY\x01\x00\x76\x00", 10);
  bytes += head;
  Gaussian gauss(channels);
  std::vector<double> values;
  for (std::size_t k = 0; k < rows; ++k)
    for (std::size_t c = 0; c < channels; ++c) values.push_back(static_cast<double>(c + 1) * gauss());
  bytes.append(reinterpret_cast<const char*>(values.data()), 8 * values.size());
  write_file(path, bytes);
  return path.string();
}

/// One channel of float64 in numpy's format: a log that is divided.
inline std::string write_long_log(const std::filesystem::path& path, std::uint64_t seed, std::size_t rows) {
  std::string head = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}", rows);
  head.resize(117, ' ');
  head += '\n';
  std::string bytes("\x93NUMPY\x01\x00\x76\x00", 10);
  bytes += head;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(rows);
  for (double& value : values) value = normal(engine);
  bytes.append(reinterpret_cast<const char*>(values.data()), 8 * rows);
  write_file(path, bytes);
  return path.string();
}

inline libchar::FleetPlan planned(const std::vector<std::string>& logs, const libchar::FleetPlanOptions& options = {}) {
  return libchar::plan_fleet(libchar::manifest_of_logs(logs), options);
}

inline void run_all(const libchar::FleetPlan& plan, const std::filesystem::path& fleet) {
  for (const libchar::FleetUnit& unit : plan.units) libchar::run_unit(unit, fleet);
}

}  // namespace test
