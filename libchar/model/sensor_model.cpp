#include "libchar/model/sensor_model.hpp"

#include "libchar/core/axis_name.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
double simulated_value(const Coefficient& coefficient) { return coefficient.value.value_or(0); }

std::string kind_of(const SensorModel& model) {
  if (!model.kind.empty()) return model.kind;
  const auto unit = find_unit(model.unit);
  if (!unit) return "sensor";
  switch (unit->quantity) {
    case Quantity::angular_rate:
      return "gyroscope";
    case Quantity::acceleration:
      return "accelerometer";
    case Quantity::magnetic_field:
      return "magnetometer";
    case Quantity::pressure:
      return "barometer";
    case Quantity::temperature:
      return "thermometer";
    default:
      return "sensor";
  }
}

std::string axis_of(const SensorModel& model) {
  if (!model.axis.empty()) return model.axis;
  const char axis = axis_name(model.channel).axis;
  return axis == 0 ? "" : std::string(1, axis);
}

}  // namespace libchar
