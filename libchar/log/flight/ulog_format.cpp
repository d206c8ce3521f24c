#include "libchar/log/flight/ulog_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/file.hpp"

namespace libchar {
namespace {

constexpr std::string_view kUlogMagic = "ULog\x01\x12\x35";
constexpr std::string_view kUlogEncrypted = "ULogEnc";
constexpr std::size_t kFlagBytes = 40;  // 8 that may be ignored, 8 that may not, 3 offsets

// Bits that change how the file has to be read: only "data were appended" is known.
void refuse_unknown_flags(std::span<const std::byte> flags, const std::string& path) {
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const auto bits = std::to_integer<unsigned>(flags[i]) & (i == 0 ? 0xfeU : 0xffU);
    if (bits == 0) continue;
    throw input_error("E0482", fmt::format("{} (byte {}, field incompat_flags)", path, kUlogHeader + 3 + 8 + i))
        .says("needs a later reader: bits 0x{:02x} of the flags that may not be ignored are set", bits)
        .hint("convert it with PX4's own tools");
  }
}

void split_at_appended(std::span<const std::byte> offsets, const BinaryFile& file, UlogHeader& header,
                       Findings& warnings) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint64_t offset = little_endian<8>(offsets.data() + 8 * i);
    if (offset == 0) return;
    UlogStretch& last = header.stretches.back();
    if (offset <= last.first || offset >= file.size()) {
      warnings.add("appended_lost", fmt::format("data were appended at byte {}, which the file does not hold", offset));
      return;
    }
    last.end = offset;
    header.stretches.push_back({offset, file.size()});
  }
}

}  // namespace

bool is_ulog(std::string_view first_bytes) {
  return first_bytes.starts_with(kUlogMagic) || first_bytes.starts_with(kUlogEncrypted);
}

UlogHeader read_ulog_header(const BinaryFile& file, Findings& warnings) {
  const std::string head = file.head(kUlogHeader + 3 + kFlagBytes);
  const std::string& path = file.path();
  if (head.starts_with(kUlogEncrypted))
    throw input_error("E0481", path)
        .says("is an encrypted ULog")
        .hint("decrypt it first, with PX4's Tools/decrypt_ulog.py");
  if (!head.starts_with(kUlogMagic)) throw input_error("E0480", path).says(wrong_start(head, kUlogMagic, "a ULog"));
  if (head.size() < kUlogHeader)
    throw input_error("E0480", fmt::format("{} (byte {})", path, head.size()))
        .says("is cut inside the {} bytes of its header", kUlogHeader);
  UlogHeader header;
  header.version = static_cast<unsigned char>(head[7]);
  header.stretches = {{kUlogHeader, file.size()}};
  const auto bytes = std::as_bytes(std::span(head)).subspan(kUlogHeader);
  const bool flags = bytes.size() == 3 + kFlagBytes && static_cast<char>(bytes[2]) == 'B' &&
                     little_endian<2>(bytes.data()) >= kFlagBytes;
  if (!flags) return header;
  refuse_unknown_flags(bytes.subspan(3 + 8, 8), path);
  if ((std::to_integer<unsigned>(bytes[3 + 8]) & 1U) != 0)
    split_at_appended(bytes.subspan(3 + 16), file, header, warnings);
  return header;
}

UlogInfo read_ulog_info(std::span<const std::byte> body) {
  if (body.empty()) return {};
  const auto length = std::to_integer<std::size_t>(body[0]);
  if (1 + length > body.size()) return {};
  const auto text = [&](std::size_t from, std::size_t count) {
    return std::string(reinterpret_cast<const char*>(body.data()) + from, count);
  };
  const std::string key = text(1, length);
  const std::size_t blank = key.find(' ');
  if (blank == std::string::npos) return {};
  UlogInfo info;
  info.key = key.substr(blank + 1);
  const std::size_t value = 1 + length;
  if (key.starts_with("char[")) {
    info.value = text(value, std::min<std::size_t>(body.size() - value, 64));
  } else if (key.starts_with("uint32_t ") && body.size() - value == 4) {
    const auto number = static_cast<std::uint32_t>(little_endian<4>(body.data() + value));
    info.value = fmt::format("v{}.{}.{}", number >> 24U, number >> 16U & 255U, number >> 8U & 255U);
    const std::uint32_t kind = number & 255U;
    if (kind < 255)
      info.value += kind >= 192 ? " (RC)" : kind >= 128 ? " (beta)" : kind >= 64 ? " (alpha)" : " (development)";
  }
  return info;
}

namespace {

constexpr int kDeepest = 32;  // formats within formats
constexpr std::size_t kLongestName = 255;
constexpr std::uint32_t kMostBytes = 65535 - 2;  // of a message of data
constexpr std::uint64_t kMostFields = 200000, kMostSteps = 4000000;

std::optional<NumberType> ulog_number(std::string_view type) {
  static constexpr std::array<std::pair<std::string_view, NumberType>, 12> kTypes = {{{"int8_t", NumberType::i8},
                                                                                      {"uint8_t", NumberType::u8},
                                                                                      {"int16_t", NumberType::i16},
                                                                                      {"uint16_t", NumberType::u16},
                                                                                      {"int32_t", NumberType::i32},
                                                                                      {"uint32_t", NumberType::u32},
                                                                                      {"int64_t", NumberType::i64},
                                                                                      {"uint64_t", NumberType::u64},
                                                                                      {"float", NumberType::f32},
                                                                                      {"double", NumberType::f64},
                                                                                      {"bool", NumberType::u8},
                                                                                      {"char", NumberType::i8}}};
  for (const auto& [word, number] : kTypes)
    if (word == type) return number;
  return std::nullopt;
}

}  // namespace

void UlogFormats::add(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0) return;
  const std::string name(text.substr(0, colon));
  Definition definition;
  definition.text = text;
  std::string_view rest = text.substr(colon + 1);
  while (!rest.empty()) {
    const std::size_t end = rest.find(';');
    const std::string_view one = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    Member member;
    if (one.empty()) continue;
    if (!parse_member(one, member)) {
      definition.why_not = fmt::format("its format has a field that cannot be read: {}", printable(one, 40));
      break;
    }
    definition.members.push_back(std::move(member));
  }
  const auto [place, fresh] = definitions_.try_emplace(name, std::move(definition));
  if (fresh || place->second.text == text) return;
  place->second.why_not = "the log defines its format twice, and not alike";
  contradicted_ = true;
}

// "type name" or "type[n] name".
bool UlogFormats::parse_member(std::string_view text, Member& member) {
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos || blank == 0 || blank + 1 == text.size()) return false;
  std::string_view type = text.substr(0, blank);
  member.name = text.substr(blank + 1);
  const std::size_t bracket = type.find('[');
  if (bracket != std::string_view::npos) {
    const std::string_view number = type.substr(bracket + 1);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), member.count);
    if (error != std::errc() || end + 1 != number.data() + number.size() || *end != ']') return false;
    member.array = true;
    type = type.substr(0, bracket);
  }
  member.type = type;
  return !type.empty();
}

UlogLayout UlogFormats::layout(const std::string& name) {
  UlogLayout out;
  out.why_not = flatten(name, "", 0, out);
  out.least_bytes = out.bytes;
  if (!out.why_not.empty()) {
    out.fields.clear();
    return out;
  }
  // Padding at the end of the outermost format is not written.
  const std::vector<Member>& members = definitions_.find(name)->second.members;
  for (auto last = members.rbegin(); last != members.rend(); ++last) {
    const auto number = ulog_number(last->type);
    if (!last->name.starts_with("_padding") || !number) break;
    out.least_bytes -= last->count * static_cast<std::uint32_t>(size_of(*number));
  }
  return out;
}

std::string UlogFormats::flatten(const std::string& format, const std::string& prefix, int depth, UlogLayout& out) {
  const auto found = definitions_.find(format);
  if (found == definitions_.end()) return fmt::format("the log does not define its format {}", printable(format, 40));
  if (!found->second.why_not.empty()) return found->second.why_not;
  if (depth > kDeepest) return "its format holds itself";
  for (const Member& member : found->second.members) {
    std::string why_not = flatten_member(member, prefix, depth, out);
    if (!why_not.empty()) return why_not;
  }
  return "";
}

std::string UlogFormats::flatten_member(const Member& member, const std::string& prefix, int depth, UlogLayout& out) {
  if (prefix.size() + member.name.size() > kLongestName)
    return fmt::format("its fields have names of more than {} characters", kLongestName);
  const auto number = ulog_number(member.type);
  const std::uint64_t size = number ? size_of(*number) : 0;
  if (out.bytes + size * member.count > kMostBytes) return "its format is longer than a message can be";
  if (number && (member.name.starts_with("_padding") || member.type == "char")) {
    out.bytes += static_cast<std::uint32_t>(size * member.count);
    return "";
  }
  for (std::uint32_t k = 0; k < member.count; ++k) {
    if (++steps_ > kMostSteps || fields_ == kMostFields) return "the formats of the log have too many fields in all";
    const std::string name = member.array ? fmt::format("{}{}[{}]", prefix, member.name, k) : prefix + member.name;
    if (!number) {
      std::string why_not = flatten(member.type, name + ".", depth + 1, out);
      if (!why_not.empty()) return why_not;
      continue;
    }
    out.fields.push_back({name, *number, out.bytes});
    out.bytes += static_cast<std::uint32_t>(size);
    ++fields_;
  }
  return "";
}

namespace {

struct FieldUnit {
  std::string_view message, field, unit;
};

constexpr std::array kUnits = {
    FieldUnit{"sensor_gyro", "x", "rad/s"},
    FieldUnit{"sensor_gyro", "y", "rad/s"},
    FieldUnit{"sensor_gyro", "z", "rad/s"},
    FieldUnit{"sensor_gyro", "temperature", "degC"},
    FieldUnit{"sensor_gyro_fifo", "x", "rad/s"},
    FieldUnit{"sensor_gyro_fifo", "y", "rad/s"},
    FieldUnit{"sensor_gyro_fifo", "z", "rad/s"},
    FieldUnit{"sensor_accel", "x", "m/s^2"},
    FieldUnit{"sensor_accel", "y", "m/s^2"},
    FieldUnit{"sensor_accel", "z", "m/s^2"},
    FieldUnit{"sensor_accel", "temperature", "degC"},
    FieldUnit{"sensor_accel_fifo", "x", "m/s^2"},
    FieldUnit{"sensor_accel_fifo", "y", "m/s^2"},
    FieldUnit{"sensor_accel_fifo", "z", "m/s^2"},
    FieldUnit{"sensor_mag", "x", "Gauss"},
    FieldUnit{"sensor_mag", "y", "Gauss"},
    FieldUnit{"sensor_mag", "z", "Gauss"},
    FieldUnit{"sensor_mag", "temperature", "degC"},
    FieldUnit{"sensor_baro", "pressure", "Pa"},  // hPa before version 1.14: ulog.cpp looks at the value
    FieldUnit{"sensor_baro", "temperature", "degC"},
    FieldUnit{"sensor_baro", "altitude", "m"},
    FieldUnit{"sensor_hygrometer", "temperature", "degC"},
    FieldUnit{"sensor_hygrometer", "humidity", "%"},
    FieldUnit{"sensor_combined", "gyro_rad", "rad/s"},
    FieldUnit{"sensor_combined", "accelerometer_m_s2", "m/s^2"},
    FieldUnit{"sensor_combined", "magnetometer_ga", "Gauss"},
    FieldUnit{"sensor_combined", "baro_alt_meter", "m"},
    FieldUnit{"sensor_combined", "baro_temp_celcius", "degC"},
    FieldUnit{"vehicle_imu", "delta_angle", "rad"},
    FieldUnit{"vehicle_imu", "delta_velocity", "m/s"},
    FieldUnit{"vehicle_imu_status", "mean_accel", "m/s^2"},
    FieldUnit{"vehicle_imu_status", "mean_gyro", "rad/s"},
    FieldUnit{"vehicle_imu_status", "temperature_accel", "degC"},
    FieldUnit{"vehicle_imu_status", "temperature_gyro", "degC"},
    FieldUnit{"vehicle_imu_status", "accel_vibration_metric", "m/s^2"},
    FieldUnit{"vehicle_imu_status", "gyro_vibration_metric", "rad/s"},
    FieldUnit{"vehicle_imu_status", "accel_rate_hz", "Hz"},
    FieldUnit{"vehicle_imu_status", "gyro_rate_hz", "Hz"},
    FieldUnit{"vehicle_imu_status", "accel_raw_rate_hz", "Hz"},
    FieldUnit{"vehicle_imu_status", "gyro_raw_rate_hz", "Hz"},
    FieldUnit{"vehicle_angular_velocity", "xyz", "rad/s"},
    FieldUnit{"vehicle_angular_velocity", "xyz_derivative", "rad/s^2"},
    FieldUnit{"vehicle_acceleration", "xyz", "m/s^2"},
    FieldUnit{"vehicle_magnetometer", "magnetometer_ga", "Gauss"},
    FieldUnit{"vehicle_air_data", "baro_alt_meter", "m"},
    FieldUnit{"vehicle_air_data", "baro_temp_celcius", "degC"},
    FieldUnit{"vehicle_air_data", "ambient_temperature", "degC"},
    FieldUnit{"vehicle_air_data", "baro_pressure_pa", "Pa"},
    FieldUnit{"vehicle_air_data", "rho", "kg/m^3"},
    FieldUnit{"differential_pressure", "differential_pressure_pa", "Pa"},
    FieldUnit{"differential_pressure", "differential_pressure_raw_pa", "Pa"},
    FieldUnit{"differential_pressure", "differential_pressure_filtered_pa", "Pa"},
    FieldUnit{"differential_pressure", "temperature", "degC"},
    FieldUnit{"distance_sensor", "current_distance", "m"},
    FieldUnit{"battery_status", "voltage_v", "V"},
    FieldUnit{"battery_status", "current_a", "A"},
    FieldUnit{"battery_status", "temperature", "degC"},
};

constexpr std::array<std::string_view, 11> kSensors = {
    "sensor_gyro",       "sensor_gyro_fifo", "sensor_accel", "sensor_accel_fifo",     "sensor_mag",     "sensor_baro",
    "sensor_hygrometer", "sensor_combined",  "vehicle_imu",  "differential_pressure", "distance_sensor"};

constexpr std::array<std::string_view, 7> kNoSamples = {
    "timestamp", "timestamp_sample", "error_count", "clip_counter", "samples", "is_external", "calibration_count"};

}  // namespace

std::optional<std::string_view> px4_unit(std::string_view message, std::string_view field) {
  if (field == "timestamp" || field == "timestamp_sample") return "us";
  const auto found = std::find_if(kUnits.begin(), kUnits.end(),
                                  [&](const FieldUnit& row) { return row.message == message && row.field == field; });
  if (found == kUnits.end()) return std::nullopt;
  return found->unit;
}

bool px4_sensor(std::string_view message) {
  return std::find(kSensors.begin(), kSensors.end(), message) != kSensors.end();
}

bool px4_no_sample(std::string_view field) {
  return field.ends_with("device_id") || field.ends_with("_calibration_count") || field.ends_with("_clipping") ||
         field.ends_with("timestamp_relative") || field.ends_with("_dt") ||
         std::find(kNoSamples.begin(), kNoSamples.end(), field) != kNoSamples.end();
}

}  // namespace libchar
