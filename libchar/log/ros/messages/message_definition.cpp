#include "libchar/log/ros/messages/message_definition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/column_name.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostFields = 100000;          // of all types of a text
constexpr std::uint64_t kLongestArray = 1000000000;  // of a fixed array

struct PrimitiveName {
  std::string_view name;
  Primitive kind;
};

constexpr std::array kPrimitives = {
    PrimitiveName{"bool", Primitive::boolean},     PrimitiveName{"byte", Primitive::u8},
    PrimitiveName{"char", Primitive::u8},          PrimitiveName{"int8", Primitive::i8},
    PrimitiveName{"uint8", Primitive::u8},         PrimitiveName{"int16", Primitive::i16},
    PrimitiveName{"uint16", Primitive::u16},       PrimitiveName{"int32", Primitive::i32},
    PrimitiveName{"uint32", Primitive::u32},       PrimitiveName{"int64", Primitive::i64},
    PrimitiveName{"uint64", Primitive::u64},       PrimitiveName{"float32", Primitive::f32},
    PrimitiveName{"float64", Primitive::f64},      PrimitiveName{"string", Primitive::text},
    PrimitiveName{"wstring", Primitive::wide_text}};

bool name_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

// "[]", "[9]", "[<=9]" behind a type. False when it is none of them.
bool read_repeat(std::string_view brackets, MessageField& field) {
  const std::string_view inside = brackets.substr(1, brackets.size() - 2);
  if (inside.empty() || inside.starts_with("<=")) {
    field.repeat = Repeat::variable;
    return true;
  }
  field.repeat = Repeat::fixed;
  const auto [end, code] = std::from_chars(inside.data(), inside.data() + inside.size(), field.count);
  return code == std::errc() && end == inside.data() + inside.size() && field.count <= kLongestArray;
}

// The type of a field without brackets and bounds.
void read_type(std::string_view word, std::string_view package, bool ros1, MessageField& field) {
  for (const PrimitiveName& known : kPrimitives)
    if (known.name == word) {
      field.kind = known.kind;
      return;
    }
  if (ros1 && (word == "time" || word == "duration")) {
    field.kind = word == "time" ? Primitive::time1 : Primitive::duration1;
    return;
  }
  field.type = word == "Header"                           ? "std_msgs/Header"
               : word.find('/') == std::string_view::npos ? fmt::format("{}/{}", package, word)
                                                          : plain_type_name(word);
  const bool stamp = field.type == "builtin_interfaces/Time" || field.type == "builtin_interfaces/Duration";
  field.kind = stamp ? Primitive::time : Primitive::message;
}

// A line without its comment: a field, or nothing (a constant, an empty line). False when it is neither.
bool read_line(std::string_view line, std::string_view package, bool ros1, MessageType& type) {
  line = trimmed(line.substr(0, line.find('#')));
  if (line.empty()) return true;
  const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
  std::string_view word = line.substr(0, end);
  std::string_view rest = trimmed(line.substr(end));
  std::size_t letters = 0;
  while (letters < rest.size() && name_letter(rest[letters])) ++letters;
  if (letters == 0) return false;
  const std::string_view behind = trimmed(rest.substr(letters));
  if (behind.starts_with('=')) return true;  // a constant
  MessageField field;
  field.name = rest.substr(0, letters);
  if (word.ends_with(']')) {
    const std::size_t open = word.rfind('[');
    if (open == std::string_view::npos || !read_repeat(word.substr(open), field)) return false;
    word = word.substr(0, open);
  }
  word = word.substr(0, word.find("<="));
  if (word.empty()) return false;
  read_type(word, package, ros1, field);
  type.fields.push_back(std::move(field));
  return true;
}

std::string_view package_of(std::string_view type) { return type.substr(0, type.find('/')); }

bool parting_line(std::string_view line) {
  return line.size() >= 20 && std::all_of(line.begin(), line.end(), [](char c) { return c == '='; });
}

}  // namespace

std::string plain_type_name(std::string_view type) {
  const std::size_t first = type.find('/'), last = type.rfind('/');
  if (first == std::string_view::npos) return std::string(type);
  return fmt::format("{}/{}", type.substr(0, first), type.substr(last + 1));
}

std::string add_message_types(std::string_view type, std::string_view text, bool ros1, MessageTypes& types) {
  std::vector<MessageType> found(1);
  found.back().name = plain_type_name(type);
  std::size_t fields = 0;
  bool parted = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    line = trimmed(line);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (parting_line(line)) {
      parted = true;
      continue;
    }
    if (parted && line.starts_with("MSG:")) {
      found.emplace_back().name = plain_type_name(trimmed(line.substr(4)));
      parted = false;
      continue;
    }
    if (!read_line(line, package_of(found.back().name), ros1, found.back()))
      return fmt::format("its definition cannot be read (\"{}\")", printable(line, 40));
    if (++fields > kMostFields) return fmt::format("a definition of more than {} lines", kMostFields);
  }
  for (MessageType& one : found) {
    std::string name = one.name;
    types.try_emplace(std::move(name), std::move(one));
  }
  return "";
}

namespace {

struct MemberUnit {
  std::string_view type, member, unit;
};

constexpr std::array kUnits = {MemberUnit{"geometry_msgs/Twist", "linear", "m/s"},
                               MemberUnit{"geometry_msgs/Twist", "angular", "rad/s"},
                               MemberUnit{"geometry_msgs/Accel", "linear", "m/s^2"},
                               MemberUnit{"geometry_msgs/Accel", "angular", "rad/s^2"},
                               MemberUnit{"geometry_msgs/Wrench", "force", "N"},
                               MemberUnit{"geometry_msgs/Wrench", "torque", "N·m"},
                               MemberUnit{"geometry_msgs/Pose", "position", "m"},
                               MemberUnit{"geometry_msgs/Transform", "translation", "m"},
                               MemberUnit{"geometry_msgs/PointStamped", "point", "m"},
                               MemberUnit{"sensor_msgs/Imu", "angular_velocity", "rad/s"},
                               MemberUnit{"sensor_msgs/Imu", "linear_acceleration", "m/s^2"},
                               MemberUnit{"sensor_msgs/MagneticField", "magnetic_field", "T"},
                               MemberUnit{"sensor_msgs/FluidPressure", "fluid_pressure", "Pa"},
                               MemberUnit{"sensor_msgs/Temperature", "temperature", "degC"},
                               MemberUnit{"sensor_msgs/RelativeHumidity", "relative_humidity", "1"},
                               MemberUnit{"sensor_msgs/Illuminance", "illuminance", "lx"},
                               MemberUnit{"sensor_msgs/Range", "range", "m"},
                               MemberUnit{"sensor_msgs/Range", "min_range", "m"},
                               MemberUnit{"sensor_msgs/Range", "max_range", "m"},
                               MemberUnit{"sensor_msgs/Range", "field_of_view", "rad"},
                               MemberUnit{"sensor_msgs/NavSatFix", "latitude", "deg"},
                               MemberUnit{"sensor_msgs/NavSatFix", "longitude", "deg"},
                               MemberUnit{"sensor_msgs/NavSatFix", "altitude", "m"},
                               MemberUnit{"sensor_msgs/BatteryState", "voltage", "V"},
                               MemberUnit{"sensor_msgs/BatteryState", "temperature", "degC"},
                               MemberUnit{"sensor_msgs/BatteryState", "current", "A"},
                               MemberUnit{"sensor_msgs/LaserScan", "angle_min", "rad"},
                               MemberUnit{"sensor_msgs/LaserScan", "angle_max", "rad"},
                               MemberUnit{"sensor_msgs/LaserScan", "angle_increment", "rad"},
                               MemberUnit{"sensor_msgs/LaserScan", "time_increment", "s"},
                               MemberUnit{"sensor_msgs/LaserScan", "scan_time", "s"},
                               MemberUnit{"sensor_msgs/LaserScan", "range_min", "m"},
                               MemberUnit{"sensor_msgs/LaserScan", "range_max", "m"},
                               MemberUnit{"sensor_msgs/LaserScan", "ranges", "m"},
                               MemberUnit{"px4_msgs/SensorCombined", "gyro_rad", "rad/s"},
                               MemberUnit{"px4_msgs/SensorCombined", "accelerometer_m_s2", "m/s^2"},
                               MemberUnit{"px4_msgs/SensorGyro", "x", "rad/s"},
                               MemberUnit{"px4_msgs/SensorGyro", "y", "rad/s"},
                               MemberUnit{"px4_msgs/SensorGyro", "z", "rad/s"},
                               MemberUnit{"px4_msgs/SensorGyro", "temperature", "degC"},
                               MemberUnit{"px4_msgs/SensorAccel", "x", "m/s^2"},
                               MemberUnit{"px4_msgs/SensorAccel", "y", "m/s^2"},
                               MemberUnit{"px4_msgs/SensorAccel", "z", "m/s^2"},
                               MemberUnit{"px4_msgs/SensorAccel", "temperature", "degC"},
                               MemberUnit{"px4_msgs/SensorBaro", "pressure", "Pa"},
                               MemberUnit{"px4_msgs/SensorBaro", "temperature", "degC"}};

// What stands in a message for whoever computes with it, and is no sample.
constexpr std::array<std::string_view, 3> kBeside = {"header", "timestamp", "timestamp_sample"};

struct NoNumbers {
  std::string_view type, why;
};

constexpr std::array kNoNumbers = {NoNumbers{"sensor_msgs/Image", "images"},
                                   NoNumbers{"sensor_msgs/CompressedImage", "images"},
                                   NoNumbers{"sensor_msgs/CameraInfo", "camera calibration"},
                                   NoNumbers{"sensor_msgs/PointCloud", "point clouds"},
                                   NoNumbers{"sensor_msgs/PointCloud2", "point clouds"},
                                   NoNumbers{"nav_msgs/OccupancyGrid", "maps"},
                                   NoNumbers{"nav_msgs/Path", "paths"},
                                   NoNumbers{"visualization_msgs/Marker", "markers"},
                                   NoNumbers{"visualization_msgs/MarkerArray", "markers"},
                                   NoNumbers{"foxglove_msgs/CompressedVideo", "video"},
                                   NoNumbers{"foxglove_msgs/CompressedImage", "images"},
                                   NoNumbers{"foxglove_msgs/RawImage", "images"},
                                   NoNumbers{"foxglove_msgs/PointCloud", "point clouds"}};

// Every paragraph of known_messages.msg as types of its own, in the order of the text.
const std::vector<MessageType>& known_types() {
  static const std::vector<MessageType> table = [] {
    std::vector<MessageType> types;
    std::string_view text = known_message_text();
    while (!text.empty()) {
      const std::size_t end = std::min(text.find("\n\n"), text.size());
      const std::string_view paragraph = text.substr(0, end);
      text.remove_prefix(std::min(end + 2, text.size()));
      const std::size_t name = paragraph.find('\n');
      MessageTypes one;
      add_message_types(paragraph.substr(0, name), paragraph.substr(name + 1), false, one);
      for (auto& entry : one) types.push_back(std::move(entry.second));
    }
    return types;
  }();
  return table;
}

}  // namespace

KnownMember known_member(std::string_view type, std::string_view member) {
  KnownMember known;
  known.usual = !member.ends_with("covariance") && !member.ends_with("covariance_type") &&
                !(member == "variance" && type.starts_with("sensor_msgs/")) && type != "std_msgs/MultiArrayLayout" &&
                std::find(kBeside.begin(), kBeside.end(), member) == kBeside.end();
  for (const MemberUnit& row : kUnits)
    if (row.type == type && row.member == member) known.unit = row.unit;
  return known;
}

bool sensor_type(std::string_view type) {
  return (type.starts_with("sensor_msgs/") || type.starts_with("px4_msgs/Sensor")) && no_numbers_of(type).empty() &&
         type != "sensor_msgs/Joy";
}

std::string_view no_numbers_of(std::string_view type) {
  for (const NoNumbers& row : kNoNumbers)
    if (row.type == type) return row.why;
  return "";
}

std::vector<MessageTypes> known_definitions(std::string_view type) {
  std::vector<MessageTypes> versions;
  for (const MessageType& known : known_types()) {
    if (known.name != type) continue;
    MessageTypes types;
    types.emplace(known.name, known);
    complete_types(types);
    versions.push_back(std::move(types));
  }
  return versions;
}

void complete_types(MessageTypes& types) {
  std::vector<std::string> wanted;
  for (const auto& [name, type] : types)
    for (const MessageField& field : type.fields)
      if (field.kind == Primitive::message) wanted.push_back(field.type);
  while (!wanted.empty()) {
    const std::string name = std::move(wanted.back());
    wanted.pop_back();
    if (types.contains(name)) continue;
    const auto& known = known_types();
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const MessageType& one) { return one.name == name; });
    if (found == known.end()) continue;
    types.emplace(name, *found);
    for (const MessageField& field : found->fields)
      if (field.kind == Primitive::message) wanted.push_back(field.type);
  }
}

}  // namespace libchar
