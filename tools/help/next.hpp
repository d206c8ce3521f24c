#pragma once
// Where results go when nobody says so, and what to type next.

#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/lot/fleet_lot.hpp"
#include "session.hpp"

namespace sensorchar {

/// "imu-report" of "logs/imu.csv": in the current folder, for results of this kind.
std::string default_folder(const std::string& input, const std::string& kind = "report");

/// " --missing=-999": options of characterize that mend the worst of these findings; "" where none does.
std::string mending_flags(const std::vector<libchar::Finding>& findings);

/// The same command again, with options that mend the worst of these findings; "" where none does.
std::string mended_command(const Session& session, const std::vector<libchar::Finding>& findings,
                           const std::string& folder);

/// Of a characterization in a folder, the most useful first: the same command with what mends the worst that was
/// found, the file of an IMU for Kalibr, a figure, what the worst finding means.
std::vector<std::string> next_steps(const Session& session, const libchar::Characterization& result,
                                    const std::string& folder);

/// Of the report of a lot in a folder: the worst device next to another one, and whether its files are still whole.
std::vector<std::string> next_steps(const std::string& folder, std::span<const libchar::DeviceRecord> records,
                                    const libchar::FleetLot& lot);

/// Of a bench in a folder: the same once more, held against it.
std::vector<std::string> bench_again(const Session& session, const std::string& folder);

/// The line that says so; nothing when quiet, or for "".
void say_next(const Session& session, const std::string& command);

}  // namespace sensorchar
