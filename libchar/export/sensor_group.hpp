#pragma once
// Models that belong to one device: who is the gyroscope, who the accelerometer, and which axis
// each model speaks of.

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// One model in its place, and the factor that brings its unit to rad/s, m/s^2, T, Pa…
struct PlacedModel {
  const SensorModel* model = nullptr;
  double to_si = 1;
};

/// The models of one kind along x, y and z.
struct SensorTriad {
  std::string kind;     ///< "gyroscope", "accelerometer", "magnetometer"
  std::string si_unit;  ///< "rad/s", "m/s^2", "T"
  std::array<std::optional<PlacedModel>, 3> axis;
  bool shared = false;  ///< one model without an axis stands for all three
};

struct SensorGroup {
  std::optional<SensorTriad> gyroscope, accelerometer, magnetometer;
  std::vector<const SensorModel*> others;  ///< barometers, thermometers, unknown ones
  std::vector<const SensorModel*> all;     ///< in the order given
  std::vector<std::string>
      unexpressed;  ///< what the models hold and the file they go to cannot say
};

/// What the user says of a channel that neither its name nor its unit says: ("imu_3", "gx"). Places
/// are gx gy gz, ax ay az, mx my mz, and g, a, m for one model that stands for all three axes.
using AxisOverrides = std::vector<std::pair<std::string, std::string>>;

/// Sorts the models (which must outlive the group). Throws Error(input) when two claim one place,
/// when a model among several says no axis, or when its unit is not that of its kind; Error(usage)
/// for an override that names no channel or no place. Axes may be missing: `require_axes` asks for
/// them.
SensorGroup group_sensors(const std::vector<SensorModel>& models, const AxisOverrides& overrides);

/// Throws Error(input) unless all three axes (or the one named by `only`, 0…2) have a model.
void require_axes(const SensorTriad& triad, std::optional<std::size_t> only);

}  // namespace libchar
