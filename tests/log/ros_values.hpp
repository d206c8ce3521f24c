#pragma once
// What stands in fixtures/ros, by the formulas of its generators: the same numbers in MCAP, bags and databases.

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/rows.hpp"
#include "tests/support/shared.hpp"

namespace test {

inline constexpr std::int64_t kRosStart = 1700000000000000000;

inline std::filesystem::path ros(const std::string& name) { return fixture("ros/" + name); }

inline libchar::ReadOptions of_topic(const std::string& topic, std::vector<std::string> channels = {}) {
  libchar::ReadOptions options;
  options.topic = topic;
  options.channels = std::move(channels);
  return options;
}

inline std::string channel_names(const libchar::LogInfo& info) {
  std::string all;
  for (const libchar::Channel& channel : info.channels)
    all += (all.empty() ? "" : " ") + channel.name + (channel.unit.empty() ? "" : "[" + channel.unit + "]");
  return all;
}

/// The sentence with which reading is refused, "" when it is not.
inline std::string refusal(const std::string& format, const std::filesystem::path& path,
                           const libchar::ReadOptions& options = {}) {
  try {
    read_rows(format, path, options);
    return "";
  } catch (const libchar::Error& error) {
    return error.what();
  }
}

/// The first `n` messages of an IMU at 200 Hz, header stamps; without orientation, whose covariance
/// says that it is not measured.
inline void check_imu(const Rows& rows, std::size_t n) {
  CHECK(channel_names(rows.info) ==
        "angular_velocity.x[rad/s] angular_velocity.y[rad/s] angular_velocity.z[rad/s] linear_acceleration.x[m/s^2] "
        "linear_acceleration.y[m/s^2] linear_acceleration.z[m/s^2]");
  CHECK(rows.info.time.column == "header.stamp");
  REQUIRE(rows.columns.size() == 6);
  REQUIRE(rows.time_ns.size() == n);
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<double>(k);
    const double expected[] = {0.001 * i - 0.3, std::sqrt(i), -i / 7, 0.25 * i, 1 / (i + 1), 9.81 - i * 1e-4};
    for (std::size_t c = 0; c < 6; ++c) wrong += rows.columns[c][k] != expected[c] ? 1 : 0;
    wrong += rows.time_ns[k] != kRosStart + static_cast<std::int64_t>(k) * 5000000 ? 1 : 0;
  }
  CHECK(wrong == 0);
}

/// A file of fixtures/ros cut at every `step`-th byte: what is read is the beginning of what the
/// whole one holds, and a loss is said.
inline void check_cuts(const std::string& format, const std::string& name, const std::string& topic,
                       std::size_t step = 1000) {
  const std::string bytes = slurp(ros(name));
  const Rows whole = read_rows(format, ros(name), of_topic(topic));
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / ("cut." + format);
  std::size_t longest = 0, said = 0, cuts = 0;
  for (std::size_t cut = 0; cut < bytes.size(); cut += step) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes.substr(0, cut);
    INFO(name << " cut at " << cut);
    ++cuts;
    try {
      const Rows rows = read_rows(format, path, of_topic(topic), true);
      REQUIRE(rows.columns.size() == whole.columns.size());
      const std::size_t n = rows.time_ns.size();
      REQUIRE(n <= whole.time_ns.size());
      CHECK(n >= longest);  // a longer piece holds more
      longest = n;
      CHECK(std::equal(rows.time_ns.begin(), rows.time_ns.end(), whole.time_ns.begin()));
      for (std::size_t c = 0; c < whole.columns.size(); ++c)
        CHECK(std::equal(rows.columns[c].begin(), rows.columns[c].end(), whole.columns[c].begin()));
      const bool loss = rows.warnings.find("cut_end") != nullptr || rows.warnings.find("lost_messages") != nullptr;
      CHECK(loss);
      said += loss ? 1 : 0;
    } catch (const libchar::Error& error) {
      CHECK(error.problem().code.starts_with("E04"));
      CHECK(longest == 0);  // only what has no message is refused
    }
  }
  CHECK(longest > whole.time_ns.size() * 9 / 10);
  CHECK(said > cuts / 2);
}

}  // namespace test
