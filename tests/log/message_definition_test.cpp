// Definitions of ROS messages, and the steps that are made of them, on messages laid out by hand.

#include "libchar/log/ros/messages/message_definition.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "libchar/log/ros/messages/message_decoder.hpp"

using namespace libchar;

namespace {

std::string bar() { return std::string(80, '=') + "\n"; }

template <typename T>
void put(std::string& to, T value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::vector<std::byte> message(const std::string& bytes) {
  const auto* from = reinterpret_cast<const std::byte*>(bytes.data());
  return {from, from + bytes.size()};
}

MessageFormat format_of(const std::string& definition, const std::string& example = "",
                        const std::string& encoding = "ros1") {
  MessageFormat format;
  format.type = "a/B";
  format.message_encoding = encoding;
  format.definition_encoding = encoding == "ros1" ? "ros1msg" : "ros2msg";
  format.definition = definition;
  format.example = message(example);
  return format;
}

std::string why(const std::string& definition, const std::string& example = "", const std::string& encoding = "ros1") {
  return make_decoder(format_of(definition, example, encoding)).why_not;
}

std::string fields_of_definition(const MessageFormat& format) {
  const DecoderOrReason made = make_decoder(format);
  if (!made.decoder) return made.why_not;
  std::string all;
  for (const NumberField& field : made.decoder->fields()) all += field.name + " ";
  return all;
}

}  // namespace

TEST_CASE("definitions: comments, constants, defaults, bounds and arrays are told apart") {
  MessageTypes types;
  CHECK(add_message_types("p/msg/T",
                          "# a comment\n\nuint8 A=1 # constant\nstring S = x # is = kept\r\n"
                          "float64 x 1.5\nstring<=10 name \"a#b\"\nint32[<=4] some\nbyte[3] three\n"
                          "Other other\nq/msg/Third[] thirds\ntime t\nHeader header\n" +
                              bar() + "MSG: p/Other\nbool b\n",
                          true, types) == "");
  const MessageType& type = types.at("p/T");
  REQUIRE(type.fields.size() == 8);
  CHECK(type.fields[0].name == "x");
  CHECK(type.fields[1].kind == Primitive::text);
  CHECK(type.fields[2].repeat == Repeat::variable);
  CHECK(type.fields[3].count == 3);
  CHECK(type.fields[4].type == "p/Other");
  CHECK(type.fields[5].type == "q/Third");
  CHECK(type.fields[6].kind == Primitive::time1);
  CHECK(type.fields[7].type == "std_msgs/Header");
  CHECK(types.at("p/Other").fields.size() == 1);
  CHECK(add_message_types("p/T", "float64", true, types) != "");
  CHECK(add_message_types("p/T", "float64[x] a", true, types) != "");
  CHECK(add_message_types("p/T", "float64[99999999999999999999] a", true, types) != "");
}

TEST_CASE("definitions that cannot be used have a reason") {
  CHECK_THAT(why("Missing m\n"), Catch::Contains("a/Missing is missing"));
  CHECK_THAT(why("B again\n"), Catch::Contains("nested too deep"));
  CHECK_THAT(why("wstring w\nfloat64 x\n", "", "cdr"), Catch::Contains("its field w is wide text"));
  CHECK(why("string s\n") == "no numbers");
  CHECK(why("float64[100] x\n") == "arrays of more than 64 numbers");
  CHECK_THAT(why("float64 x\n", "1234"), Catch::Contains("do not fit"));
  CHECK_THAT(why("float64 x\n", "123456789"), Catch::Contains("do not fit"));
  CHECK(why("float64 x\n", "12345678").empty());
  CHECK_THAT(why("float64 x\n", std::string("\0\2\0\0", 4) + "12345678", "cdr"), Catch::Contains("encapsulation"));
  // Two of the next in each of 40 types: 2^40 fields.
  std::string doubling = "T1 a\nT1 b\n";
  for (int i = 1; i < 20; ++i)
    doubling += bar() + "MSG: a/T" + std::to_string(i) + "\nT" + std::to_string(i + 1) + " a\nT" +
                std::to_string(i + 1) + " b\n";
  CHECK_THAT(why(doubling + bar() + "MSG: a/T20\nfloat64 x\n"), Catch::Contains("too large"));
}

TEST_CASE("CDR: every value is aligned to its size behind the encapsulation, in either byte order") {
  // bool, then a double at 8, i16 at 16, a text at 20, f32 at 28.
  for (const bool big : {false, true}) {
    std::string text = big ? std::string("\0\0\0\0", 4) : std::string("\0\1\0\0", 4);
    const auto add = [&](auto value) {
      std::string bytes;
      put(bytes, value);
      if (big) std::reverse(bytes.begin(), bytes.end());
      text += bytes;
    };
    text += '\1' + std::string(7, '\0');
    add(2.5);
    add(std::int16_t{-3});
    text += std::string(2, '\0');
    add(std::uint32_t{3});
    text += std::string("ab\0", 3) + '\0';
    add(1.25F);
    const std::string definition = "bool on\nfloat64 x\nint16 n\nstring s\nfloat32 last\n";
    const DecoderOrReason made = make_decoder(format_of(definition, text, "cdr"));
    REQUIRE(made.decoder);
    made.decoder->select({3, 1, 0, 2}, std::nullopt);
    std::vector<double> row(4);
    std::int64_t stamp = 0;
    std::uint64_t rounded = 0;
    REQUIRE(made.decoder->decode(message(text), row, stamp, rounded) == Decoded::well);
    CHECK(row == std::vector<double>{1.25, 2.5, 1, -3});
    for (std::size_t cut = 0; cut < text.size(); ++cut)
      CHECK(made.decoder->decode(message(text.substr(0, cut)), row, stamp, rounded) == Decoded::misfit);
    CHECK(made.decoder->decode(message(text + "123"), row, stamp, rounded) == Decoded::well);
    CHECK(made.decoder->decode(message(text + "1234"), row, stamp, rounded) == Decoded::misfit);
  }
}

TEST_CASE("CDR version 2 aligns to 4, and an empty array of doubles aligns nothing") {
  std::string text("\0\7\0\0", 4);
  put(text, std::int32_t{7});
  put(text, 2.5);  // at 4
  const DecoderOrReason two = make_decoder(format_of("int32 n\nfloat64 x\n", text, "cdr"));
  REQUIRE(two.decoder);
  std::string empty("\0\1\0\0", 4);
  put(empty, std::uint32_t{0});
  put(empty, std::int32_t{9});
  const DecoderOrReason none = make_decoder(format_of("float64[] many\nint32 n\n", empty, "cdr"));
  REQUIRE(none.decoder);
  none.decoder->select({0}, std::nullopt);
  std::vector<double> row(1);
  std::int64_t stamp = 0;
  std::uint64_t rounded = 0;
  CHECK(none.decoder->decode(message(empty), row, stamp, rounded) == Decoded::well);
  CHECK(row[0] == 9);
}

TEST_CASE("arrays of messages with lengths of their own: the first elements are fields") {
  std::string text;
  put(text, std::uint32_t{2});
  for (const double x : {1.5, 2.5}) {
    put(text, x);
    put(text, std::uint32_t{1});
    text += 'n';
  }
  put(text, std::int32_t{-4});
  const std::string definition = "C[] cs\nint32 end\n" + bar() + "MSG: a/C\nfloat64 x\nstring name\n";
  CHECK(fields_of_definition(format_of(definition, text)) == "cs[0].x cs[1].x end ");
  const DecoderOrReason made = make_decoder(format_of(definition, text));
  made.decoder->select({2, 1}, std::nullopt);
  std::vector<double> row(2);
  std::int64_t stamp = 0;
  std::uint64_t rounded = 0;
  CHECK(made.decoder->decode(message(text), row, stamp, rounded) == Decoded::well);
  CHECK(row == std::vector<double>{-4, 2.5});
  // One element less: what it lacks is missing. 2^32 - 1 elements: the message is not that long.
  std::string shorter;
  put(shorter, std::uint32_t{1});
  shorter += text.substr(4, 13) + text.substr(text.size() - 4);
  CHECK(made.decoder->decode(message(shorter), row, stamp, rounded) == Decoded::other_length);
  CHECK(row[0] == -4);
  CHECK(std::isnan(row[1]));
  std::string endless = text;
  std::memset(endless.data(), 0xff, 4);
  CHECK(made.decoder->decode(message(endless), row, stamp, rounded) == Decoded::misfit);
}

TEST_CASE("every type that the program knows can be compiled, and knows its parts") {
  for (const char* type : {"sensor_msgs/Imu",
                           "sensor_msgs/MagneticField",
                           "sensor_msgs/Temperature",
                           "sensor_msgs/FluidPressure",
                           "sensor_msgs/RelativeHumidity",
                           "sensor_msgs/Range",
                           "sensor_msgs/NavSatFix",
                           "sensor_msgs/Illuminance",
                           "sensor_msgs/JointState",
                           "sensor_msgs/BatteryState",
                           "sensor_msgs/LaserScan",
                           "sensor_msgs/TimeReference",
                           "geometry_msgs/Vector3",
                           "geometry_msgs/Vector3Stamped",
                           "geometry_msgs/Twist",
                           "geometry_msgs/TwistStamped",
                           "geometry_msgs/AccelStamped",
                           "geometry_msgs/WrenchStamped",
                           "geometry_msgs/QuaternionStamped",
                           "geometry_msgs/PoseStamped",
                           "geometry_msgs/Accel",
                           "geometry_msgs/TransformStamped",
                           "tf2_msgs/TFMessage",
                           "nav_msgs/Odometry",
                           "std_msgs/Float32",
                           "std_msgs/Float64",
                           "std_msgs/Int64",
                           "std_msgs/UInt8",
                           "std_msgs/Float64MultiArray",
                           "std_msgs/Bool"}) {
    INFO(type);
    const auto versions = known_definitions(type);
    REQUIRE_FALSE(versions.empty());
    for (const MessageTypes& types : versions) {
      const CompiledMessage compiled = compile_message(types, type, {});
      CHECK(compiled.problem == "");
      const bool only_lists = std::string(type).ends_with("TFMessage") || std::string(type).ends_with("MultiArray");
      CHECK((!compiled.fields.empty() || only_lists));
    }
  }
  CHECK(known_definitions("sensor_msgs/Range").size() == 2);
  CHECK(known_definitions("a/B").empty());
}
