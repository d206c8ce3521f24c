// The table of consumers: files and report hold what its rows say.

#include "libchar/export/detail/consumer_rows.hpp"

#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "libchar/core/text/readable.hpp"
#include "libchar/export/exports.hpp"
#include "tests/export/imu_models.hpp"

using namespace libchar;

TEST_CASE("consumer rows: every row belongs to a target, every target but json has rows") {
  std::set<std::string> with_rows;
  for (const ConsumerRow& row : consumer_table()) {
    std::string_view words = row.targets;
    while (!words.empty()) {
      const std::size_t end = words.find(' ');
      with_rows.emplace(words.substr(0, end));
      words.remove_prefix(end == std::string_view::npos ? words.size() : end + 1);
    }
  }
  std::set<std::string> targets = {"ardupilot"};  // in the file of px4
  for (const ExportTarget& target : export_targets()) targets.emplace(target.name);
  targets.erase("json");  // the model itself
  CHECK(with_rows == targets);
}

TEST_CASE("consumer rows: the report shows the number that the file holds") {
  const auto models = test::euroc_imu();
  std::map<std::string, std::string> shown;
  for (const SensorModel& model : models)
    for (const ConsumerNumber& n : consumer_numbers(model.noise, model.unit, model.rate_hz))
      shown[n.consumer + "/" + n.key] = n.value;
  const auto check = [&](const char* target, const char* consumer, const char* key) {
    CAPTURE(target, key);
    const double written = test::number_after(test::exported(target, models).text, key);
    const std::string value = shown.at(std::string(consumer) + "/" + key);
    CHECK(std::set{number_text(written, 2), number_text(written, 3), number_text(written, 4), number_text(written, 5)}
              .count(value) == 1);
  };
  check("kalibr", "Kalibr, EuRoC, OpenVINS", "gyroscope_random_walk");
  check("openvins", "Kalibr, EuRoC, OpenVINS", "accelerometer_noise_density");
  check("orbslam3", "ORB-SLAM3", "IMU.AccWalk");
  check("vins", "VINS-Mono, VINS-Fusion", "gyr_w");
  check("vins", "VINS-Mono, VINS-Fusion", "acc_n");
  check("gtsam", "GTSAM", "biasOmegaCovariance");
  check("ros", "ROS sensor_msgs/Imu", "angular_velocity_covariance");
}

TEST_CASE("consumer rows: a magnetometer has no convention in the report") {
  const auto m = test::model("mag_x", "uT", {test::known(1), test::known(2), test::known(3)});
  std::set<std::string> consumers;
  for (const ConsumerNumber& n : consumer_numbers(m.noise, m.unit, m.rate_hz)) {
    consumers.insert(n.consumer);
    CHECK((n.unit == "uT" || n.unit == "uT/√Hz"));
  }
  CHECK(consumers == std::set<std::string>{"Any discrete filter", "Data sheet"});
}

TEST_CASE("consumer rows: units in ASCII for files") {
  CHECK(ascii_unit("rad/s²/√Hz") == "rad/s^2/sqrt(Hz)");
  CHECK(ascii_unit("m³/√h") == "m^3/sqrt(h)");
  CHECK(ascii_unit("µT") == "uT");
  CHECK(ascii_unit("") == "");
}
