#include "libchar/log/binary/sidecar.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/core/json.hpp"
#include "libchar/core/text.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/binary/npy_header.hpp"
#include "libchar/log/binary/yaml_guard.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;
constexpr std::size_t kMaxName = 1024;

const std::vector<std::string> kKeys = {
    "dtype", "endian", "channels", "rate_hz", "offset", "rows", "t0_ns", "order"};
const std::vector<std::string> kChannelKeys = {"name", "unit", "scale", "offset"};

// Reads the values of one document, naming file and key in every refusal.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  Sidecar read(const Json& document) {
    if (!document.is_object())
      refuse("", "expected keys and values", brief(document), "such as " + minimal_sidecar());
    check_keys(document, kKeys, "");
    for (const char* key : {"dtype", "channels"})
      if (!document.contains(key))
        refuse(key, "the key is missing", "", "such as " + minimal_sidecar());
    Sidecar sidecar;
    sidecar.number.type = number_type(document["dtype"]);
    sidecar.number.big_endian = document.contains("endian") &&
                                word(document["endian"], "endian", {"little", "big"}) == "big";
    sidecar.planar = document.contains("order") &&
                     word(document["order"], "order", {"interleaved", "planar"}) == "planar";
    if (document.contains("offset"))
      sidecar.offset = count(
          document["offset"], "offset", "the number of bytes to skip, a whole number not below 0");
    if (document.contains("rows"))
      sidecar.rows = count(document["rows"], "rows", "a whole number above 0");
    if (sidecar.rows == std::uint64_t{0}) refuse("rows", "expected a whole number above 0", "0");
    if (document.contains("t0_ns")) sidecar.t0_ns = stamp(document["t0_ns"]);
    if (document.contains("rate_hz")) sidecar.rate_hz = rate(document["rate_hz"]);
    read_channels(document["channels"], sidecar);
    if (!document.contains("endian") && size_of(sidecar.number.type) > 1)
      refuse("endian", "the key is missing", "", "little or big; a PC writes little");
    return sidecar;
  }

 private:
  [[noreturn]] void refuse(const std::string& key,
                           std::string what,
                           std::string got = "",
                           std::string hint = "") const {
    const std::string where = key.empty() ? file_ : fmt::format("{} (key {})", file_, key);
    throw Error(
        {ErrorKind::input, "E0420", where, std::move(what), std::move(got), std::move(hint)});
  }
  static std::string brief(const Json& value) {
    return value.dump(-1, ' ', false, Json::error_handler_t::replace).substr(0, 200);
  }

  void check_keys(const Json& object,
                  const std::vector<std::string>& known,
                  const std::string& parent) const {
    for (const auto& item : object.items()) {
      if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
      const auto near = nearest(item.key(), known);
      refuse(parent + printable(item.key(), 40),
             "unknown key",
             "",
             near ? fmt::format("did you mean {}?", *near)
                  : fmt::format("known keys: {}", fmt::join(known, ", ")));
    }
  }

  std::string text(const Json& value, const std::string& key) const {
    if (!value.is_string()) refuse(key, "expected a text", brief(value));
    return value.get<std::string>();
  }

  std::string word(const Json& value,
                   const std::string& key,
                   const std::vector<std::string>& words) const {
    const std::string got = text(value, key);
    if (std::find(words.begin(), words.end(), got) == words.end())
      refuse(key, fmt::format("expected {}", fmt::join(words, " or ")), got);
    return got;
  }

  NumberType number_type(const Json& value) const {
    const std::string got = text(value, "dtype");
    const auto type = find_number_type(got);
    if (type && *type != NumberType::f16) return *type;
    std::string lower = got;
    for (char& c : lower) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    const std::vector<std::string> names = {
        "f64", "f32", "i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64"};
    const auto near = nearest(lower, names);
    refuse("dtype",
           fmt::format("expected one of {}", fmt::join(names, ", ")),
           got,
           near ? fmt::format("did you mean {}?", *near) : "");
  }

  std::uint64_t count(const Json& value,
                      const std::string& key,
                      const std::string& expected) const {
    if (value.is_number_unsigned()) return value.get<std::uint64_t>();
    refuse(key,
           "expected " + expected,
           brief(value),
           key == "offset" ? "the offset of a channel's values stands within channels" : "");
  }

  std::int64_t stamp(const Json& value) const {
    const bool fits = value.is_number_integer() &&
                      !(value.is_number_unsigned() &&
                        value.get<std::uint64_t>() >
                            static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()));
    if (!fits) refuse("t0_ns", "expected a time in whole nanoseconds", brief(value));
    return value.get<std::int64_t>();
  }

  double finite(const Json& value, const std::string& key, const std::string& expected) const {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      refuse(key, "expected " + expected, brief(value));
    return value.get<double>();
  }

  double rate(const Json& value) const {
    const double hz = finite(value, "rate_hz", "a sampling rate in hertz, above 0");
    if (!(hz >= 1e-9 && hz <= 1e12))
      refuse("rate_hz", "expected a sampling rate in hertz, from 1e-9 to 1e12", brief(value));
    return hz;
  }

  void read_channels(const Json& value, Sidecar& sidecar) const {
    const std::string expected = "a number of channels, or a list of {name, unit, scale, offset}";
    if (value.is_array()) {
      if (value.empty()) refuse("channels", "the list is empty");
      check_number(value.size());
      sidecar.named = true;
      for (const Json& item : value) sidecar.channels.push_back(read_channel(item, sidecar));
      return;
    }
    const std::uint64_t n = count(value, "channels", expected);
    if (n == 0) refuse("channels", "there must be at least one channel", "0");
    check_number(n);
    for (std::uint64_t i = 0; i < n; ++i)
      sidecar.channels.push_back({fmt::format("c{}", i), "", 1, 0});
  }

  void check_number(std::uint64_t n) const {
    if (n > kMaxColumns)
      refuse("channels", fmt::format("{} channels, more than the limit of {}", n, kMaxColumns));
  }

  SidecarChannel read_channel(const Json& item, const Sidecar& so_far) const {
    const std::string place = fmt::format("channels[{}]", so_far.channels.size());
    if (!item.is_object()) refuse(place, "expected {name, unit, scale, offset}", brief(item));
    check_keys(item, kChannelKeys, place + ".");
    SidecarChannel channel;
    if (!item.contains("name")) refuse(place + ".name", "the key is missing");
    channel.name = text(item["name"], place + ".name");
    if (channel.name.empty() || channel.name.size() > kMaxName)
      refuse(
          place + ".name", fmt::format("expected a name of 1 to {} bytes", kMaxName), channel.name);
    for (const SidecarChannel& other : so_far.channels)
      if (other.name == channel.name)
        refuse(place + ".name", "two channels have one name", channel.name);
    if (item.contains("unit")) channel.unit = text(item["unit"], place + ".unit");
    if (item.contains("scale")) channel.scale = finite(item["scale"], place + ".scale", "a number");
    if (item.contains("offset"))
      channel.offset = finite(item["offset"], place + ".offset", "a number (added to every value)");
    if (channel.scale == 0)
      refuse(place + ".scale", "a scale of 0 makes every value the same", "0");
    return channel;
  }

  std::string file_;
};

bool exists(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0;
}

}  // namespace

std::string find_sidecar(const std::string& log) {
  std::string found;
  for (const char* suffix : {".json", ".yaml", ".yml"}) {
    const std::string path = log + suffix;
    if (!exists(path)) continue;
    if (!found.empty())
      throw Error({ErrorKind::input,
                   "E0421",
                   path,
                   "there are two sidecars of one log",
                   found,
                   "keep one of them"});
    found = path;
  }
  return found;
}

Sidecar parse_sidecar(std::string_view text, const std::string& file, bool json) {
  return Reader(file).read(json ? parse_json(text, file) : parse_guarded_yaml(text, file));
}

Sidecar read_sidecar(const std::string& path) {
  const BinaryFile file(path);
  if (file.size() > kMaxBytes)
    throw Error(
        {ErrorKind::input,
         "E0605",
         path,
         fmt::format("a sidecar of {} bytes exceeds the limit of {}", file.size(), kMaxBytes),
         "",
         ""});
  return parse_sidecar(file.head(kMaxBytes), path, path.ends_with(".json"));
}

std::string sidecar_json(const Sidecar& sidecar) {
  Json document;
  document["dtype"] = std::string(name_of(sidecar.number.type));
  document["endian"] = sidecar.number.big_endian ? "big" : "little";
  if (sidecar.named) {
    document["channels"] = Json::array();
    for (const SidecarChannel& channel : sidecar.channels) {
      Json item;
      item["name"] = channel.name;
      if (!channel.unit.empty()) item["unit"] = channel.unit;
      if (channel.scale != 1) item["scale"] = channel.scale;
      if (channel.offset != 0) item["offset"] = channel.offset;
      document["channels"].push_back(std::move(item));
    }
  } else {
    document["channels"] = sidecar.channels.size();
  }
  if (sidecar.rate_hz > 0) document["rate_hz"] = sidecar.rate_hz;
  document["offset"] = sidecar.offset;
  if (sidecar.rows) document["rows"] = *sidecar.rows;
  if (sidecar.t0_ns) document["t0_ns"] = *sidecar.t0_ns;
  document["order"] = sidecar.planar ? "planar" : "interleaved";
  return dump_json(document);
}

std::string minimal_sidecar() {
  return R"({"dtype": "f64", "endian": "little", "channels": 3, "rate_hz": 200.0})";
}

}  // namespace libchar
