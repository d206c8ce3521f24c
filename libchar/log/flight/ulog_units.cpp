#include "libchar/log/flight/ulog_units.hpp"

#include <algorithm>
#include <array>

namespace libchar {
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
    FieldUnit{
        "sensor_baro", "pressure", "Pa"},  // hPa before version 1.14: ulog.cpp looks at the value
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

constexpr std::array<std::string_view, 11> kSensors = {"sensor_gyro",
                                                       "sensor_gyro_fifo",
                                                       "sensor_accel",
                                                       "sensor_accel_fifo",
                                                       "sensor_mag",
                                                       "sensor_baro",
                                                       "sensor_hygrometer",
                                                       "sensor_combined",
                                                       "vehicle_imu",
                                                       "differential_pressure",
                                                       "distance_sensor"};

constexpr std::array<std::string_view, 7> kNoSamples = {"timestamp",
                                                        "timestamp_sample",
                                                        "error_count",
                                                        "clip_counter",
                                                        "samples",
                                                        "is_external",
                                                        "calibration_count"};

}  // namespace

std::optional<std::string_view> px4_unit(std::string_view message, std::string_view field) {
  if (field == "timestamp" || field == "timestamp_sample") return "us";
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), [&](const FieldUnit& row) {
    return row.message == message && row.field == field;
  });
  if (found == kUnits.end()) return std::nullopt;
  return found->unit;
}

bool px4_sensor(std::string_view message) {
  return std::find(kSensors.begin(), kSensors.end(), message) != kSensors.end();
}

bool px4_no_sample(std::string_view field) {
  return field.ends_with("device_id") || field.ends_with("_calibration_count") ||
         field.ends_with("_clipping") || field.ends_with("timestamp_relative") ||
         field.ends_with("_dt") ||
         std::find(kNoSamples.begin(), kNoSamples.end(), field) != kNoSamples.end();
}

}  // namespace libchar
