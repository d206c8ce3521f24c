#include "libchar/fleet/unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/characterize/settings.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/process/version.hpp"

namespace libchar {
namespace {

constexpr std::string_view kTaskFormat = "fleet-task";
constexpr std::size_t kIdDigits = 32;

/// What the result depends on.
Json content_of(const FleetUnit& unit) {
  Json out = {{"version_of_program", version()},
              {"kind", name_of(unit.kind)},
              {"sha256", unit.sha256},
              {"config", json_of(settings_of(*unit.options))},
              {"reports", unit.reports}};
  if (!unit.settings.empty()) out["settings"] = unit.settings;
  if (unit.kind == UnitKind::stretch) out["leaves"] = {unit.stretch.first_leaf, unit.stretch.end_leaf};
  if (unit.kind == UnitKind::join) out["parts"] = unit.parts;
  return out;
}

std::string id_of(const std::string& what, const Json& content) {
  Sha256 hash;
  hash.update(what + with_valid_text(content).dump());
  return hash.finish().substr(0, kIdDigits);
}

UnitKind kind_at(const MapReader& at) { return *find_enum<UnitKind>(at.word("kind", words_of<UnitKind>())); }

StretchRange stretch_at(const MapReader& at) {
  const std::vector<double> ends = at.numbers("leaves");
  constexpr double kMost = 0x1p53;  // numbers of a document are whole up to here
  const auto is_leaf = [&](double end) { return end >= 0 && end <= kMost && end == std::floor(end); };
  if (ends.size() != 2 || !is_leaf(ends[0]) || !is_leaf(ends[1]) || !(ends[1] > ends[0]))
    at.refuse("leaves", "expected the first leaf and the one after the last");
  return {static_cast<std::uint64_t>(ends[0]), static_cast<std::uint64_t>(ends[1])};
}

/// Results are found by these: they lead nowhere else.
bool is_id(std::string_view word) {
  return word.size() == kIdDigits && word.find_first_not_of("0123456789abcdef") == word.npos;
}

std::vector<std::string> parts_at(const MapReader& at) {
  std::vector<std::string> parts = at.texts("parts");
  if (parts.empty() || !std::all_of(parts.begin(), parts.end(), is_id))
    at.refuse("parts", "expected the names of the stretches that are joined");
  return parts;
}

}  // namespace

std::string unit_id(const FleetUnit& unit) { return id_of("fleet-unit 1\n", content_of(unit)); }

std::string settings_id(const CharacterizeOptions& options) {
  // Which channel of a log a unit is of is no way to characterize it.
  CharacterizeOptions alike = options;
  alike.reading.channels.clear();
  return id_of("settings 1\n", json_of(settings_of(alike)));
}

std::string settings_id(const FleetUnit& unit) {
  return unit.settings.empty() ? settings_id(*unit.options) : unit.settings;
}

std::string analysis_id(const FleetUnit& unit) {
  CharacterizeOptions alike = *unit.options;
  alike.reading = {};
  if (!alike.temperature.empty()) alike.temperature = "a thermometer";
  return id_of("analysis 1\n", json_of(settings_of(alike)));
}

std::string unit_text(const FleetUnit& unit) {
  Json out = {{"format", kTaskFormat}, {"version", 1}, {"id", unit.id}, {"log", unit.log}};
  out["bytes"] = unit.bytes;
  if (unit.stated) out["stated"] = true;
  out.update(content_of(unit));
  out["device"] = unit.device;
  out["cost"] = {{"seconds", unit.cost.seconds}, {"memory_bytes", unit.cost.memory_bytes}};
  return with_valid_text(std::move(out)).dump();
}

SharedOptions OptionsTable::of(const CharacterizeOptions& options) {
  const auto [at, fresh] = known_.try_emplace(json_of(settings_of(options)).dump());
  if (fresh) at->second = std::make_shared<const CharacterizeOptions>(options);
  return at->second;
}

FleetUnit parse_unit(std::string_view text, const std::string& path) {
  OptionsTable alone;
  return parse_unit(text, path, alone);
}

FleetUnit parse_unit(std::string_view text, const std::string& path, OptionsTable& shared) {
  const Document document = parse_json_document(text, path);
  check_format(document, path, kTaskFormat, 1);
  const MapReader at(document, path, "",
                     {"format", "version", "id", "version_of_program", "kind", "device", "log", "sha256", "stated",
                      "bytes", "leaves", "parts", "reports", "config", "settings", "cost"});
  FleetUnit unit;
  unit.id = at.text("id");
  unit.kind = kind_at(at);
  unit.device = detail::in_memory(at.count_or("device", 0));
  unit.log = at.text("log");
  unit.sha256 = at.text("sha256");
  unit.stated = at.flag_or("stated", false);
  unit.bytes = at.count("bytes");
  unit.reports = at.flag_or("reports", true);
  if (unit.kind == UnitKind::stretch) unit.stretch = stretch_at(at);
  if (unit.kind == UnitKind::join) unit.parts = parts_at(at);
  CharacterizeOptions options;
  read_fields(characterize_fields(), at.map("config", keys_of(characterize_fields())), options);
  unit.options = shared.of(options);
  unit.settings = at.text_or("settings", "");
  const MapReader cost = at.map("cost", {"seconds", "memory_bytes"});
  unit.cost = {cost.number("seconds", kNotNegative), cost.count("memory_bytes")};
  if (at.text("version_of_program") != version())
    at.refuse("version_of_program",
              fmt::format("the task was planned by another version of the program than {}", version()),
              "plan the fleet again with this one; results of the other version stay");
  if (unit_id(unit) != unit.id) at.refuse("id", "the task was changed after it was planned", "plan the fleet again");
  return unit;
}

}  // namespace libchar
