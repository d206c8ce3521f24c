#pragma once
// Which logs a fleet has, and what belongs to each: a manifest (YAML, JSON or CSV, docs/fleet.md), or the logs alone.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

struct FleetDevice {
  std::string device;  ///< name; several logs of one device are runs of it
  std::string log;     ///< absolute path
  std::string type;    ///< devices of one type are compared; "" is one too
  std::string batch;
  std::string limits;                   ///< what the data sheet allows, absolute path; "": nothing
  std::optional<double> temperature_c;  ///< of the surroundings while it was recorded
  std::string sha256;       ///< of the log, as somebody states it, in lower case; "": not stated
  std::size_t options = 0;  ///< index in `Manifest::options`
  std::string where;        ///< "FILE:LINE:COL" of the entry, for refusals
};

struct Manifest {
  std::string file;                          ///< "": there is none, logs were named
  std::vector<FleetDevice> devices;          ///< in the order of the file
  std::vector<CharacterizeOptions> options;  ///< as many as differ
};

/// Paths are relative to the manifest's folder. `options` are those that an entry does not set.
/// Throws Error(input) with place, key and the nearest valid key.
Manifest read_manifest(const std::string& path, const CharacterizeOptions& options = {});

/// The same from text that stands for a file at `path`; a table where the path ends in .csv or .tsv.
Manifest parse_manifest(std::string_view text,
                        const std::string& path,
                        const CharacterizeOptions& options = {});

/// Each log is a device of its own, called as its file is; by their folders too where two are
/// alike. A word with * ? [ that is not a file stands for the matching files. Throws Error(input)
/// where none does, Error(usage) for a manifest among them.
Manifest manifest_of_logs(const std::vector<std::string>& words,
                          const CharacterizeOptions& options = {});

/// What is meant as a manifest, right or not: YAML, a file that says `fleet-manifest`, a table with
/// a column `log` or `device` in any case and spelling nearby that holds no samples.
bool is_manifest(const std::string& path);

}  // namespace libchar
