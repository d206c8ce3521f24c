#include "libchar/log/ros/messages/known_messages.hpp"

#include <algorithm>
#include <array>

namespace libchar {
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
