#pragma once
// Which logs a fleet has, and what belongs to each: a manifest (YAML, JSON or CSV, docs/fleet.md), or the logs alone.

#include <map>
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
  std::string sha256;                   ///< of the log, as somebody states it, in lower case; "": not stated
  std::size_t options = 0;              ///< index in `Manifest::options`
  std::string where;                    ///< "FILE:LINE:COL" of the entry, for refusals
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
Manifest parse_manifest(std::string_view text, const std::string& path, const CharacterizeOptions& options = {});

/// Each log is a device of its own, called as its file is; by their folders too where two are
/// alike. A word with * ? [ that is not a file stands for the matching files. Throws Error(input)
/// where none does, Error(usage) for a manifest among them.
Manifest manifest_of_logs(const std::vector<std::string>& words, const CharacterizeOptions& options = {});

/// What is meant as a manifest, right or not: YAML, a file that says `fleet-manifest`, a table with
/// a column `log` or `device` in any case and spelling nearby that holds no samples.
bool is_manifest(const std::string& path);

// Digests of logs that somebody took already, as `sha256sum` prints them: a plan need not take them
// again. They are trusted until a worker reads the log.

struct StatedDigest {
  std::string sha256;  ///< 64 lower-case hexadecimal digits
  std::string where;   ///< "FILE:LINE:COL"
};

/// Of each log, by its absolute path.
using StatedDigests = std::map<std::string, StatedDigest>;

/// Lines "DIGEST  PATH", "DIGEST *PATH" or "SHA256 (PATH) = DIGEST"; paths are relative to the
/// file's folder; empty lines and those that begin with # are left out. Throws Error(input) with
/// the place of any other line, and for two digests of one path.
StatedDigests parse_sums(std::string_view text, const std::string& path);
/// The same of files. Throws Error(input).
StatedDigests read_sums(const std::vector<std::string>& paths);

/// Gives each device the digest of its log, where there is one, and returns how many got none.
/// Throws Error(input) where the manifest states another.
std::size_t state_digests(const StatedDigests& digests, Manifest& manifest);

}  // namespace libchar
