#include "libchar/fusion/algorithms/virtual_sensor.hpp"

#include <utility>

namespace libchar::fusion {

VirtualSensor::VirtualSensor(const Array& array, const Settings& settings)
    : filter_(std::make_unique<BiasFilter>(
          array, settings["slowest_s"], static_cast<Eigen::Index>(settings["most_states"]),
          InputModel{settings["input_deviation"], settings["input_corner_hz"]}, looks_ahead(settings))) {
  if (looks_ahead(settings))
    smoother_ =
        std::make_unique<BiasSmoother>(std::move(filter_), array.channels, array.inputs(), 1e6 * settings["most_mb"]);
}

void VirtualSensor::finish_learning() {
  if (smoother_) smoother_->finish();
}

void VirtualSensor::remarks(Findings& warnings) const {
  if (filter().states().size() == 0)
    warnings.add("no_drift",
                 "found no drift in the sensors' models that shows above their white noise: its weights "
                 "are constant");
  if (smoother_)
    warnings.add("looks_ahead",
                 "with smoothed=1 it estimates each instant from the whole run, what comes after it as "
                 "well: for recordings, not for use while they are made");
}

}  // namespace libchar::fusion
