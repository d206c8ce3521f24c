#include "libchar/fleet/manifest.hpp"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "libchar/characterize/settings.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/detail/log_seen.hpp"

namespace libchar {
namespace {

constexpr std::size_t kDigitsOfSum = 64;

/// 64 hexadecimal digits in lower case; nothing for any other text.
std::optional<std::string> sha256_digits(std::string_view text) {
  std::string digits = ascii_lower(text);
  if (digits.size() != kDigitsOfSum || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
    return std::nullopt;
  return digits;
}

// A small table of texts: a CSV file that people write by hand or in a spreadsheet.

struct TableRow {
  int line = 0;                    ///< in the file, from 1
  std::vector<std::string> cells;  ///< one a head
};

struct TableText {
  std::vector<std::string> heads;
  int head_line = 0;
  std::vector<TableRow> rows;
};

std::string trimmed(const std::string& cell) {
  const std::size_t first = cell.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return cell.substr(first, cell.find_last_not_of(" \t") - first + 1);
}

[[noreturn]] void refuse(const std::string& path, int line, const std::string& what) {
  throw input_error("E0781", fmt::format("{}:{}:1", path, line)).says(what);
}

/// A cell that begins with a quotation mark ends with one, and has two for each of its own (RFC
/// 4180). No other character escapes: a path may hold backslashes.
std::vector<std::string> cells_of(const std::string& line, char separator, const std::string& path, int number) {
  std::vector<std::string> cells;
  std::string cell;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool mark = line[i] == '"';
    if (quoted && mark && i + 1 < line.size() && line[i + 1] == '"')
      cell += line[i++];
    else if (quoted && mark)
      quoted = false;
    else if (!quoted && mark && trimmed(cell).empty())
      quoted = true;
    else if (!quoted && line[i] == separator)
      cells.push_back(trimmed(std::exchange(cell, "")));
    else
      cell += line[i];
  }
  if (quoted) refuse(path, number, "a quotation mark is not closed in its line");
  cells.push_back(trimmed(cell));
  return cells;
}

char separator_of(const std::string& head) {
  for (const char separator : {',', ';', '\t'})
    if (head.find(separator) != std::string::npos) return separator;
  return ',';
}

// Separated by commas, or where the head has none by semicolons, or by tabs; cells may be quoted;
// empty lines and those that begin with # are left out. Throws Error(input) for a row of another
// number of cells, a quote that is never closed. Nothing behind `most_rows` rows is looked at.
TableText parse_table_text(std::string_view text, const std::string& path, std::size_t most_rows = SIZE_MAX) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  TableText table;
  char separator = ',';
  int number = 0;
  while (!text.empty() && (table.heads.empty() || table.rows.size() < most_rows)) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (line.find_first_not_of(" \t,;") == std::string::npos || line[0] == '#') continue;
    if (table.heads.empty()) separator = separator_of(line);
    std::vector<std::string> cells = cells_of(line, separator, path, number);
    if (table.heads.empty()) {
      table.heads = std::move(cells);
      table.head_line = number;
      continue;
    }
    if (cells.size() != table.heads.size())
      refuse(path, number, fmt::format("{} cells under {} heads", cells.size(), table.heads.size()));
    table.rows.push_back({number, std::move(cells)});
  }
  return table;
}

namespace fs = std::filesystem;

constexpr std::string_view kManifestFormat = "fleet-manifest";
const std::vector<std::string> kDeviceKeys = {"device", "log", "type", "batch", "temperature_c", "limits", "sha256"};
constexpr std::size_t kMostManifest = std::size_t{256} << 20U;

std::vector<std::string> keys_with(std::vector<std::string> more) {
  std::vector<std::string> keys = kDeviceKeys;
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

/// Entries with the same options share them.
class ManifestOptions {
 public:
  explicit ManifestOptions(Manifest& manifest) : manifest_(manifest) {}
  std::size_t index(const CharacterizeOptions& options) {
    const std::string text = json_of(settings_of(options)).dump();
    const auto [at, fresh] = known_.emplace(text, manifest_.options.size());
    if (fresh) manifest_.options.push_back(options);
    return at->second;
  }

 private:
  Manifest& manifest_;
  std::map<std::string, std::size_t> known_;
};

CharacterizeOptions options_at(const MapReader& at, CharacterizeOptions options) {
  if (!at.has("options")) return options;
  read_fields(characterize_fields(), at.map("options", keys_of(characterize_fields())), options);
  return options;
}

std::string digest_at(const MapReader& at) {
  const auto digest = sha256_digits(at.text("sha256"));
  if (!digest) at.refuse("sha256", "expected the 64 hexadecimal digits of a SHA-256 digest");
  return *digest;
}

void read_device(const MapReader& at, const fs::path& folder, FleetDevice& device) {
  device.device = at.text_or("device", device.device);
  device.type = at.text_or("type", device.type);
  device.batch = at.text_or("batch", device.batch);
  if (const auto t = at.maybe_number("temperature_c", {-273.15, 1e4})) device.temperature_c = t;
  if (at.has("limits")) device.limits = absolute_path(at.text("limits"), folder);
  if (at.has("log")) device.log = absolute_path(at.text("log"), folder);
  if (at.has("sha256")) device.sha256 = digest_at(at);
}

Manifest parse_tree(std::string_view text, const std::string& path, const CharacterizeOptions& options) {
  const Document document = parse_document(text, path);
  check_format(document, path, kManifestFormat, 1);
  const MapReader top(document, path, "", {"format", "version", "defaults", "devices"});
  const fs::path folder = folder_of_file(path);
  Manifest manifest;
  ManifestOptions table(manifest);
  FleetDevice defaults;
  CharacterizeOptions common = options;
  if (top.has("defaults")) {
    const MapReader at = top.map("defaults", {"type", "batch", "temperature_c", "limits", "options"});
    read_device(at, folder, defaults);
    common = options_at(at, options);
  }
  const std::size_t common_index = table.index(common);
  std::size_t k = 0;
  for (const Document& one : top.list("devices")) {
    const MapReader at(one, path, fmt::format("devices[{}]", k++), keys_with({"options"}));
    FleetDevice device = defaults;
    at.require("log");
    read_device(at, folder, device);
    if (device.device.empty()) device.device = stem_of_log(device.log);
    device.options = at.has("options") ? table.index(options_at(at, common)) : common_index;
    device.where = at.where(one);
    manifest.devices.push_back(std::move(device));
  }
  return manifest;
}

/// Heads are keys, and wrong where they stand.
void check_heads(const TableText& table, const std::string& path) {
  if (table.heads.empty()) return;
  Document head;
  head.kind = Document::Kind::map;
  head.line = table.head_line;
  head.column = 1;
  for (const std::string& one : table.heads) {
    if (std::count(table.heads.begin(), table.heads.end(), one) > 1)
      throw input_error("E0781", fmt::format("{}:{}:1", path, table.head_line)).says("a column is repeated").got(one);
    Document value;
    value.kind = Document::Kind::text;
    head.map.push_back({one, head.line, 1, value});
  }
  MapReader(head, path, "columns", kDeviceKeys).require("log");
}

/// A cell of a table as a key of a document: what is empty is absent.
Document cell_document(const std::string& key, const std::string& cell, int line, int column) {
  Document value;
  value.kind = Document::Kind::text;
  value.text = cell;
  value.line = line;
  value.column = column;
  if (key != "temperature_c") return value;
  if (const auto number = parse_double(cell)) {
    value.kind = Document::Kind::number;
    value.number = *number;
  }  // else the reader says that it is no number
  return value;
}

Manifest parse_table(std::string_view text, const std::string& path, const CharacterizeOptions& options) {
  const TableText table = parse_table_text(text, path);
  check_heads(table, path);
  const fs::path folder = folder_of_file(path);
  Manifest manifest;
  manifest.options.push_back(options);
  for (const TableRow& row : table.rows) {
    Document one;
    one.kind = Document::Kind::map;
    one.line = row.line;
    one.column = 1;
    for (std::size_t c = 0; c < table.heads.size(); ++c)
      if (!row.cells[c].empty())
        one.map.push_back({table.heads[c], row.line, 1, cell_document(table.heads[c], row.cells[c], row.line, 1)});
    const MapReader at(one, path, "", kDeviceKeys);
    FleetDevice device;
    at.require("log");
    read_device(at, folder, device);
    if (device.device.empty()) device.device = stem_of_log(device.log);
    device.where = fmt::format("{}:{}:1", path, row.line);
    manifest.devices.push_back(std::move(device));
  }
  return manifest;
}

std::string ending_of(const std::string& path) { return ascii_lower(fs::path(path).extension().string()); }

bool is_table(const std::string& path) { return ending_of(path) == ".csv" || ending_of(path) == ".tsv"; }

/// No log is YAML, but what rosbag2 says of its own.
bool is_yaml(const std::string& path) {
  return (ending_of(path) == ".yaml" || ending_of(path) == ".yml") && !is_rosbag2(path);
}

/// In any case, and as slips are: that such a table is a manifest must not hang on a letter. "log"
/// is too short for slips: lat, lon.
bool is_head_of_log(const std::string& head) {
  return head == "log" || head == "logs" || head == "logfile" || head == "log_file" || head == "log file";
}

bool is_head(const std::string& head, std::string_view key) { return edit_distance(head, key) <= key.size() / 3; }

/// Samples, and no paths.
bool has_numbers_only(const std::string& text, const std::string& path) {
  try {
    const TableText table = parse_table_text(text, path, 1);
    return !table.rows.empty() && std::all_of(table.rows[0].cells.begin(), table.rows[0].cells.end(),
                                              [](const std::string& cell) { return parse_double(cell).has_value(); });
  } catch (const Error&) {
    return false;
  }
}

/// A column of logs and one of devices; or one of them, and half of all heads are those of a manifest.
bool has_manifest_heads(const std::string& text, const std::string& path) {
  std::vector<std::string> heads;
  try {
    heads = parse_table_text(text, path, 0).heads;
  } catch (const Error&) {
    return false;
  }
  std::size_t logs = 0, devices = 0, known = 0;
  for (const std::string& head : heads) {
    const std::string one = ascii_lower(head);
    logs += is_head_of_log(one);
    devices += is_head(one, "device");
    known += is_head_of_log(one) || std::any_of(kDeviceKeys.begin(), kDeviceKeys.end(), [&](const std::string& key) {
               return key != "log" && is_head(one, key);
             });
  }
  if (logs > 0 && devices > 0) return true;
  return logs + devices > 0 && 2 * known >= heads.size() && !has_numbers_only(text, path);
}

/// What a pattern stands for, in order: a shell has no room for a hundred thousand names. A name of a file is itself.
std::vector<std::string> files_of_pattern(const std::string& word) {
  std::error_code ignored;
  if (word.find_first_of("*?[") == std::string::npos || fs::exists(word, ignored)) return {word};
  glob_t found{};
  std::vector<std::string> out;
  if (::glob(word.c_str(), 0, nullptr, &found) == 0) out.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  if (out.empty())
    throw input_error("E0780")
        .says("no file matches this pattern")
        .got(word)
        .hint("patterns are relative to the folder that you are in");
  return out;
}

void refuse_manifest_among(const std::vector<std::string>& logs) {
  const auto manifest = std::find_if(logs.begin(), logs.end(), is_manifest);
  if (manifest == logs.end()) return;
  throw usage_error("E0205", *manifest).says("this is a manifest, given among logs").hint("name one manifest, or logs");
}

void check_devices(const Manifest& manifest, const std::string& path) {
  if (manifest.devices.empty()) throw input_error("E0780", path).says("the fleet has no device");
  for (const FleetDevice& one : manifest.devices) {
    if (one.device.empty() || first_invalid_utf8(one.device) != std::string::npos)
      throw input_error("E0780", one.where)
          .says("a device needs a name in UTF-8")
          .got(one.device)
          .hint("give it a name");
    // Plans and tasks are JSON: another path would stand there, and be sought for ever.
    for (const std::string* text : {&one.log, &one.limits, &one.type, &one.batch})
      if (first_invalid_utf8(*text) != std::string::npos)
        throw input_error("E0780", one.where)
            .says("paths and words of a fleet are in UTF-8, and this is not")
            .got(*text)
            .hint("rename the file or its folder, or save the manifest in UTF-8");
  }
}

}  // namespace

Manifest parse_manifest(std::string_view text, const std::string& path, const CharacterizeOptions& options) {
  Manifest manifest = is_table(path) ? parse_table(text, path, options) : parse_tree(text, path, options);
  manifest.file = path;
  check_devices(manifest, path);
  return manifest;
}

Manifest read_manifest(const std::string& path, const CharacterizeOptions& options) {
  return parse_manifest(file_text(path, kMostManifest), path, options);
}

Manifest manifest_of_logs(const std::vector<std::string>& words, const CharacterizeOptions& options) {
  std::vector<std::string> logs;
  for (const std::string& word : words) {
    const std::vector<std::string> found = files_of_pattern(word);
    logs.insert(logs.end(), found.begin(), found.end());
  }
  refuse_manifest_among(logs);
  Manifest manifest;
  manifest.options.push_back(options);
  const std::vector<std::string> names = names_of_logs(logs);
  for (std::size_t i = 0; i < logs.size(); ++i) {
    FleetDevice device;
    device.log = absolute_path(logs[i], fs::current_path());
    device.device = names[i];
    device.where = logs[i];
    manifest.devices.push_back(std::move(device));
  }
  check_devices(manifest, "");
  return manifest;
}

bool is_manifest(const std::string& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return is_yaml(path);  // and is refused as one
  if (!fs::is_regular_file(path, ignored)) return false;
  if (is_yaml(path)) return true;
  const std::string head = file_text(path, 4096);
  return is_table(path) ? has_manifest_heads(head, path) : head.find(kManifestFormat) != std::string::npos;
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostSums = std::size_t{1} << 30U;

struct SumLine {
  std::string sha256, path;
};

/// A name with a backslash or an end of line in it stands escaped behind a line that begins with a backslash.
std::string without_escapes(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool escape = name[i] == '\\' && i + 1 < name.size();
    if (escape) ++i;
    out += escape && name[i] == 'n' ? '\n' : escape && name[i] == 'r' ? '\r' : name[i];
  }
  return out;
}

std::optional<SumLine> digest_first(std::string_view line) {
  if (line.size() < kDigitsOfSum + 3 || line[kDigitsOfSum] != ' ') return std::nullopt;
  const char mode = line[kDigitsOfSum + 1];
  const auto digest = sha256_digits(line.substr(0, kDigitsOfSum));
  if (!digest || (mode != ' ' && mode != '*')) return std::nullopt;
  return SumLine{*digest, std::string(line.substr(kDigitsOfSum + 2))};
}

std::optional<SumLine> path_first(std::string_view line) {
  constexpr std::string_view kBegin = "SHA256 (", kMiddle = ") = ";
  if (!line.starts_with(kBegin) || line.size() < kBegin.size() + kMiddle.size() + kDigitsOfSum + 1) return std::nullopt;
  const auto digest = sha256_digits(line.substr(line.size() - kDigitsOfSum));
  line.remove_suffix(kDigitsOfSum);
  line.remove_prefix(kBegin.size());
  if (!digest || !line.ends_with(kMiddle)) return std::nullopt;
  return SumLine{*digest, std::string(line.substr(0, line.size() - kMiddle.size()))};
}

std::optional<SumLine> sum_line(std::string_view line) {
  const bool escaped = line.starts_with('\\');
  if (escaped) line.remove_prefix(1);
  std::optional<SumLine> out = digest_first(line);
  if (!out) out = path_first(line);
  if (out && escaped) out->path = without_escapes(out->path);
  return out;
}

void refuse_another(const StatedDigest& one, const StatedDigest& other, const std::string& log) {
  if (one.sha256 == other.sha256) return;
  throw input_error("E0794", one.where)
      .says("another digest is stated for this log at " + other.where)
      .got(log)
      .hint("leave the wrong one out");
}

void state(const std::string& log, const StatedDigest& one, StatedDigests& out) {
  const auto [at, fresh] = out.emplace(log, one);
  if (!fresh) refuse_another(one, at->second, log);
}

}  // namespace

StatedDigests parse_sums(std::string_view text, const std::string& path) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const fs::path folder = folder_of_file(path);
  StatedDigests out;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line[0] == '#') continue;
    const std::string where = fmt::format("{}:{}:1", path, number);
    const auto found = sum_line(line);
    if (!found)
      throw input_error("E0792", where)
          .says("expected a digest of 64 hexadecimal digits, two blanks and the path of a log")
          .got(std::string(line))
          .hint("write the file with: sha256sum LOG… > FILE");
    state(absolute_path(found->path, folder), {found->sha256, where}, out);
  }
  return out;
}

StatedDigests read_sums(const std::vector<std::string>& paths) {
  StatedDigests out;
  for (const std::string& path : paths)
    for (const auto& [log, one] : parse_sums(file_text(path, kMostSums), path)) state(log, one, out);
  return out;
}

std::size_t state_digests(const StatedDigests& digests, Manifest& manifest) {
  std::size_t without = 0;
  for (FleetDevice& device : manifest.devices) {
    const auto at = digests.find(device.log);
    if (at == digests.end()) {
      without += device.sha256.empty() ? 1 : 0;
      continue;
    }
    if (!device.sha256.empty()) refuse_another({device.sha256, device.where}, at->second, device.log);
    device.sha256 = at->second.sha256;
  }
  return without;
}

}  // namespace libchar
