#pragma once
// A unit of a fleet's work: one log, one channel of it, a stretch of a long one, or the joining of its stretches. What
// comes out of a unit depends on the log's content, the settings and the version of the program, and so does its name.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/stretches.hpp"
#include "libchar/core/document/enum_table.hpp"

namespace libchar {

enum class UnitKind {
  log,      ///< one log, or chosen channels of it, from its samples to its report
  stretch,  ///< a stretch of a long log: a partial state
  join,     ///< the partial states of a log to its report
};
template <>
inline constexpr auto enum_table<UnitKind> = enum_words<UnitKind, "log stretch join">;

struct UnitCost {
  double seconds = 0;              ///< on a core of the machine that planned
  std::uint64_t memory_bytes = 0;  ///< resident at most
};

/// A hundred thousand units of the same settings have them in memory once.
using SharedOptions = std::shared_ptr<const CharacterizeOptions>;

class OptionsTable {
 public:
  SharedOptions of(const CharacterizeOptions& options);

 private:
  std::map<std::string, SharedOptions> known_;
};

struct FleetUnit {
  std::string id;  ///< 32 hexadecimal digits (unit_id)
  UnitKind kind = UnitKind::log;
  std::size_t device = 0;  ///< index in the plan
  std::string log;         ///< absolute path
  std::string sha256;      ///< of the log when it was planned
  bool stated = false;     ///< the digest is a claim of the manifest's: the plan did not take it
  std::uint64_t bytes = 0;
  SharedOptions options = std::make_shared<const CharacterizeOptions>();
  std::string settings;            ///< settings_id of the whole log, where lists of its channels were divided
  StretchRange stretch;            ///< of a stretch
  std::vector<std::string> parts;  ///< of a join: the ids of its stretches
  bool reports = true;             ///< report.html, report.json, curves.csv and models as well as the record
  UnitCost cost;
};

/// SHA-256 over version, kind, the log's digest, settings, stretch and parts; no paths, no names, no costs.
std::string unit_id(const FleetUnit& unit);

/// SHA-256 over the settings, as short: whether two recordings were characterized alike.
std::string settings_id(const CharacterizeOptions& options);
/// The same of a unit: those of the whole log, also where it is of one channel.
std::string settings_id(const FleetUnit& unit);

/// The same of what can make results differ that come from different logs. How a log is read (its names, units, rate,
/// which rows) and which of its channels is the thermometer are not part of it. They describe what is in the log, not
/// how it is characterized.
std::string analysis_id(const FleetUnit& unit);

/// As JSON in one line ("format": "fleet-task"), and back. Throws Error(input).
std::string unit_text(const FleetUnit& unit);
FleetUnit parse_unit(std::string_view text, const std::string& path);
/// Of many units: those whose options are alike share them.
FleetUnit parse_unit(std::string_view text, const std::string& path, OptionsTable& shared);

}  // namespace libchar
