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

// The types as REPs and distributions have them, one a paragraph: its name, then its fields. Bounds, constants and
// comments, which no byte of a message depends on, are left out. Where a type has changed, the newest stands first.
constexpr std::string_view kDefinitions = R"(std_msgs/Header
builtin_interfaces/Time stamp
string frame_id

std_msgs/Bool
bool data

std_msgs/Byte
byte data

std_msgs/Char
char data

std_msgs/Float32
float32 data

std_msgs/Float64
float64 data

std_msgs/Int8
int8 data

std_msgs/Int16
int16 data

std_msgs/Int32
int32 data

std_msgs/Int64
int64 data

std_msgs/UInt8
uint8 data

std_msgs/UInt16
uint16 data

std_msgs/UInt32
uint32 data

std_msgs/UInt64
uint64 data

std_msgs/String
string data

std_msgs/ColorRGBA
float32 r
float32 g
float32 b
float32 a

std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride

std_msgs/MultiArrayLayout
MultiArrayDimension[] dim
uint32 data_offset

std_msgs/ByteMultiArray
MultiArrayLayout layout
byte[] data

std_msgs/Float32MultiArray
MultiArrayLayout layout
float32[] data

std_msgs/Float64MultiArray
MultiArrayLayout layout
float64[] data

std_msgs/Int8MultiArray
MultiArrayLayout layout
int8[] data

std_msgs/Int16MultiArray
MultiArrayLayout layout
int16[] data

std_msgs/Int32MultiArray
MultiArrayLayout layout
int32[] data

std_msgs/Int64MultiArray
MultiArrayLayout layout
int64[] data

std_msgs/UInt8MultiArray
MultiArrayLayout layout
uint8[] data

std_msgs/UInt16MultiArray
MultiArrayLayout layout
uint16[] data

std_msgs/UInt32MultiArray
MultiArrayLayout layout
uint32[] data

std_msgs/UInt64MultiArray
MultiArrayLayout layout
uint64[] data

geometry_msgs/Vector3
float64 x
float64 y
float64 z

geometry_msgs/Vector3Stamped
std_msgs/Header header
Vector3 vector

geometry_msgs/Point
float64 x
float64 y
float64 z

geometry_msgs/PointStamped
std_msgs/Header header
Point point

geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w

geometry_msgs/QuaternionStamped
std_msgs/Header header
Quaternion quaternion

geometry_msgs/Pose
Point position
Quaternion orientation

geometry_msgs/PoseStamped
std_msgs/Header header
Pose pose

geometry_msgs/Pose2D
float64 x
float64 y
float64 theta

geometry_msgs/PoseWithCovariance
Pose pose
float64[36] covariance

geometry_msgs/PoseWithCovarianceStamped
std_msgs/Header header
PoseWithCovariance pose

geometry_msgs/Transform
Vector3 translation
Quaternion rotation

geometry_msgs/TransformStamped
std_msgs/Header header
string child_frame_id
Transform transform

tf2_msgs/TFMessage
geometry_msgs/TransformStamped[] transforms

geometry_msgs/Twist
Vector3 linear
Vector3 angular

geometry_msgs/TwistStamped
std_msgs/Header header
Twist twist

geometry_msgs/TwistWithCovariance
Twist twist
float64[36] covariance

geometry_msgs/TwistWithCovarianceStamped
std_msgs/Header header
TwistWithCovariance twist

geometry_msgs/Accel
Vector3 linear
Vector3 angular

geometry_msgs/AccelStamped
std_msgs/Header header
Accel accel

geometry_msgs/AccelWithCovariance
Accel accel
float64[36] covariance

geometry_msgs/AccelWithCovarianceStamped
std_msgs/Header header
AccelWithCovariance accel

geometry_msgs/Wrench
Vector3 force
Vector3 torque

geometry_msgs/WrenchStamped
std_msgs/Header header
Wrench wrench

nav_msgs/Odometry
std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist

rosgraph_msgs/Clock
builtin_interfaces/Time clock

sensor_msgs/Imu
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance

sensor_msgs/MagneticField
std_msgs/Header header
geometry_msgs/Vector3 magnetic_field
float64[9] magnetic_field_covariance

sensor_msgs/Temperature
std_msgs/Header header
float64 temperature
float64 variance

sensor_msgs/FluidPressure
std_msgs/Header header
float64 fluid_pressure
float64 variance

sensor_msgs/RelativeHumidity
std_msgs/Header header
float64 relative_humidity
float64 variance

sensor_msgs/Illuminance
std_msgs/Header header
float64 illuminance
float64 variance

sensor_msgs/Range
std_msgs/Header header
uint8 radiation_type
float32 field_of_view
float32 min_range
float32 max_range
float32 range
float32 variance

sensor_msgs/Range
std_msgs/Header header
uint8 radiation_type
float32 field_of_view
float32 min_range
float32 max_range
float32 range

sensor_msgs/NavSatStatus
int8 status
uint16 service

sensor_msgs/NavSatFix
std_msgs/Header header
NavSatStatus status
float64 latitude
float64 longitude
float64 altitude
float64[9] position_covariance
uint8 position_covariance_type

sensor_msgs/JointState
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort

sensor_msgs/BatteryState
std_msgs/Header header
float32 voltage
float32 temperature
float32 current
float32 charge
float32 capacity
float32 design_capacity
float32 percentage
uint8 power_supply_status
uint8 power_supply_health
uint8 power_supply_technology
bool present
float32[] cell_voltage
float32[] cell_temperature
string location
string serial_number

sensor_msgs/LaserScan
std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities

sensor_msgs/TimeReference
std_msgs/Header header
builtin_interfaces/Time time_ref
string source

sensor_msgs/Joy
std_msgs/Header header
float32[] axes
int32[] buttons
)";

// Every paragraph as types of its own, in the order of the text.
const std::vector<MessageType>& known_types() {
  static const std::vector<MessageType> table = [] {
    std::vector<MessageType> types;
    std::string_view text = kDefinitions;
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
