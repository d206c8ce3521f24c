#include "libchar/log/binary/sidecar.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/fields.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/binary/npy_header.hpp"
#include "libchar/log/reading_fields.hpp"
#include "libchar/log/time/grid.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;
constexpr std::size_t kMaxName = 1024;

constexpr Word kEndians[] = {{"little", 0}, {"big", 1}};
constexpr Word kOrders[] = {{"interleaved", 0}, {"planar", 1}};

// As MapReader::refuse, with the code of the kind of slip.
Refusal key_refusal(const MapReader& at, std::string_view key, std::string code) {
  const Document* const value = at.get(key);
  return input_error(std::move(code), at.where(value == nullptr ? at.node() : *value))
      .about(at.path_of(key))
      .got(value == nullptr ? "" : shown(*value));
}

// ---- channels ----

const Fields<SidecarChannel>& channel_rows() {
  static const Fields<SidecarChannel> rows = {
      field<&SidecarChannel::name>("name",
                                   {.meaning = "unique in the file", .written = Written::always, .required = true}),
      field<&SidecarChannel::unit>("unit", {.meaning = "of the value", .otherwise = "none"}),
      field<&SidecarChannel::scale>("scale", {.meaning = "value = raw * scale + offset", .otherwise = "1"}),
      field<&SidecarChannel::offset>("offset", {.meaning = "see scale", .otherwise = "0"}),
  };
  return rows;
}

void check_number(const MapReader& at, std::uint64_t n) {
  if (n == 0) throw key_refusal(at, "channels", "E0543").says("there must be at least one channel");
  if (n > kMaxColumns)
    throw key_refusal(at, "channels", "E0543").says("{} channels, more than the limit of {}", n, kMaxColumns);
}

void read_channel(const MapReader& at, std::unordered_set<std::string>& names, Sidecar& sidecar) {
  SidecarChannel channel;
  read_fields(channel_rows(), at, channel);
  if (channel.name.empty() || channel.name.size() > kMaxName)
    throw key_refusal(at, "name", "E0543").says("expected a name of 1 to {} bytes", kMaxName);
  if (!names.insert(channel.name).second) throw key_refusal(at, "name", "E0307").says("two channels have one name");
  if (channel.scale == 0) throw key_refusal(at, "scale", "E0543").says("a scale of 0 makes every value the same");
  sidecar.channels.push_back(std::move(channel));
}

void read_channels(const MapReader& at, std::string_view key, Sidecar& sidecar) {
  const Document* const node = at.get(key);
  if (node == nullptr)
    throw key_refusal(at, key, "E0542").says("the key is missing").hint("such as " + minimal_sidecar());
  if (node->kind == Document::Kind::number && node->whole && node->number >= 0) {
    const std::uint64_t n = at.count(key);
    check_number(at, n);
    for (std::uint64_t i = 0; i < n; ++i) sidecar.channels.push_back({fmt::format("c{}", i), "", 1, 0});
    return;
  }
  if (node->kind != Document::Kind::list)
    throw key_refusal(at, key, node->kind == Document::Kind::number && node->whole ? "E0543" : "E0541")
        .says("expected a number of channels, or a list of {name, unit, scale, offset}");
  if (node->list.empty()) throw key_refusal(at, key, "E0543").says("the list is empty");
  check_number(at, node->list.size());
  sidecar.named = true;
  std::unordered_set<std::string> names;
  for (std::size_t i = 0; i < node->list.size(); ++i)
    read_channel(
        MapReader(node->list[i], at.file(), fmt::format("{}[{}]", at.path_of(key), i), keys_of(channel_rows())), names,
        sidecar);
}

void write_channels(const Field& row, const Sidecar& sidecar, std::vector<Entry>& out) {
  Entry entry{std::string(row.key), std::uint64_t{sidecar.channels.size()}};
  if (sidecar.named) {
    entry.form = Entry::Form::list;
    for (const SidecarChannel& channel : sidecar.channels) {
      Entry element;
      element.form = Entry::Form::flow;
      element.below = entries_of(channel_rows(), channel);
      entry.below.push_back(std::move(element));
    }
  }
  out.push_back(std::move(entry));
}

// ---- the file ----

void read_type(const MapReader& at, std::string_view key, Sidecar& sidecar) {
  if (!at.has(key)) throw key_refusal(at, key, "E0542").says("the key is missing").hint("such as " + minimal_sidecar());
  const std::string got = at.text(key);
  const auto type = find_number_type(got);
  if (type && *type != NumberType::f16) {
    sidecar.number.type = *type;
    return;
  }
  std::string lower = got;
  for (char& c : lower) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  const std::vector<std::string> names = {"f64", "f32", "i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64"};
  const auto near = nearest(lower, names);
  throw key_refusal(at, key, "E0544").says("expected one of {}", fmt::join(names, ", ")).hint(did_you_mean(near));
}

void write_type(const Field& row, const Sidecar& sidecar, std::vector<Entry>& out) {
  out.push_back({std::string(row.key), std::string(name_of(sidecar.number.type))});
}

void read_offset(const MapReader& at, std::string_view key, Sidecar& sidecar) {
  const Document* const node = at.get(key);
  if (node == nullptr) return;
  if (node->kind != Document::Kind::number || !node->whole || node->number < 0)
    throw key_refusal(at, key, "E0541")
        .says("expected the number of bytes to skip, a whole number not below 0")
        .hint("the offset of a channel's values belongs into channels");
  sidecar.offset = at.count(key);
}

void write_offset(const Field& row, const Sidecar& sidecar, std::vector<Entry>& out) {
  out.push_back({std::string(row.key), sidecar.offset});
}

// As a stamp of the log: room is left for sums and differences in 64 bits.
void read_start(const MapReader& at, std::string_view key, Sidecar& sidecar) {
  if (!at.has(key)) return;
  const std::int64_t start = at.whole(key);
  if (start >= kMostNs || start <= -kMostNs)
    throw key_refusal(at, key, "E0543").says("expected a time within 146 years (2^62 ns) of zero");
  sidecar.t0_ns = start;
}

void write_start(const Field& row, const Sidecar& sidecar, std::vector<Entry>& out) {
  if (sidecar.t0_ns) out.push_back({std::string(row.key), *sidecar.t0_ns});
}

Sidecar sidecar_of(const Document& document, const std::string& file) {
  const MapReader at(document, file, "", keys_of(sidecar_fields()));
  Sidecar sidecar;
  read_fields(sidecar_fields(), at, sidecar);
  if (!at.has("endian") && size_of(sidecar.number.type) > 1)
    throw key_refusal(at, "endian", "E0542").says("the key is missing").hint("little or big; a PC writes little");
  return sidecar;
}

bool exists(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0;
}

}  // namespace

const Fields<Sidecar>& sidecar_fields() {
  static const Fields<Sidecar> rows = {
      custom<Sidecar, read_type, write_type>("dtype", "f64, f32, i8 … i64, u8 … u64",
                                             {.meaning = "type of every number", .otherwise = "needed"}),
      field<&Sidecar::number, &NumberFormat::big_endian>("endian",
                                                         {.words = kEndians,
                                                          .meaning = "byte order",
                                                          .otherwise = "needed when a number has more than one byte",
                                                          .written = Written::always}),
      custom<Sidecar, read_channels, write_channels>(
          "channels", "a number, or a list of `{name, unit, scale, offset}`",
          {.meaning = "value = raw · scale + offset", .otherwise = "needed; scale 1, offset 0"}),
      field<&Sidecar::rate_hz>("rate_hz", {.unit = "Hz", .range = kRates, .meaning = "sampling rate"}),
      custom<Sidecar, read_offset, write_offset>("offset", "bytes",
                                                 {.meaning = "skipped before the first value", .otherwise = "0"}),
      field<&Sidecar::rows>("rows", {.range = {1, std::numeric_limits<double>::max(), false},
                                     .meaning = "instants",
                                     .otherwise = "what the file holds"}),
      custom<Sidecar, read_start, write_start>("t0_ns", "ns", {.meaning = "time of the first row"}),
      field<&Sidecar::planar>("order", {.words = kOrders,
                                        .meaning = "a row after the other, or a channel after the other",
                                        .otherwise = "interleaved",
                                        .written = Written::always}),
  };
  return rows;
}

std::string find_sidecar(const std::string& log) {
  std::string found;
  for (const char* suffix : {".json", ".yaml", ".yml"}) {
    const std::string path = log + suffix;
    if (!exists(path)) continue;
    if (!found.empty())
      throw input_error("E0421", path).says("there are two sidecars of one log").got(found).hint("keep one of them");
    found = path;
  }
  return found;
}

Sidecar parse_sidecar(std::string_view text, const std::string& file, bool json) {
  return sidecar_of(json ? parse_json_document(text, file) : parse_yaml_document(text, file), file);
}

Sidecar read_sidecar(const std::string& path) {
  refuse_interrupted(path);
  const BinaryFile file(path);
  if (file.size() > kMaxBytes)
    throw input_error("E0605", path).says("a sidecar of {} bytes exceeds the limit of {}", file.size(), kMaxBytes);
  return parse_sidecar(file.head(kMaxBytes), path, path.ends_with(".json"));
}

std::string sidecar_json(const Sidecar& sidecar) { return dump_json(json_of(entries_of(sidecar_fields(), sidecar))); }

std::string minimal_sidecar() { return R"({"dtype": "f64", "endian": "little", "channels": 3, "rate_hz": 200.0})"; }

}  // namespace libchar
