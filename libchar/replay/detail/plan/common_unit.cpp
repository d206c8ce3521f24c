#include "libchar/replay/detail/plan/common_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

struct Stated {
  std::string name, unit;
};

[[noreturn]] void refuse_pair(const Scene& scene, const Stated& from, const Stated& to, const char* why) {
  throw Error({ErrorKind::input, "E0918", scene.file,
               fmt::format("{} is in {}, and {} in {}: {}", printable(from.name, 40), printable(from.unit, 40),
                           printable(to.name, 40), printable(to.unit, 40), why),
               "", "leave one of them out, or say with `scale` and `unit` what its samples are"});
}

double factor_between(const Scene& scene, const Stated& from, const Stated& to) {
  if (const auto factor = Unit::sample_factor(from.unit, to.unit)) return *factor;
  refuse_pair(scene, from, to, "these are not one quantity, or no factor converts one to the other");
}

// A scale of the scene's own makes what the recording says untrue.
std::string stated_unit(const SceneSensor& sensor, const std::string& unit) {
  return sensor.unit.empty() && std::abs(sensor.scale) != 1 ? "" : unit;
}

bool seen_alike(const Scene& scene) {
  const bool one = !scene.reference || scene.reference->mean || scene.reference->channels.size() == 1;
  return one && !scene.tilt && std::all_of(scene.sensors.begin(), scene.sensors.end(), [](const auto& s) {
           return s.h.size() == 1 && s.h[0] == 1;
         });
}

// Gravity is a direction: both axes in one unit, whatever it is. What turns is a rate.
void to_unit_of_tilt(const Scene& scene, std::vector<std::string>& units, std::vector<double>& factors) {
  const auto stated = [&](std::size_t i) {
    return Stated{scene.sensors[i].name, stated_unit(scene.sensors[i], units[i])};
  };
  const std::size_t z = scene.tilt->accelerometer_z;
  const Stated from = stated(z), to = stated(scene.tilt->accelerometer_x), rate = stated(scene.tilt->gyroscope);
  if (!rate.unit.empty()) factor_between(scene, rate, {"what turns a tilt", "rad/s"});
  if (from.unit.empty() || to.unit.empty()) return;
  factors[z] = factor_between(scene, from, to);
  units[z] = to.unit;
}

}  // namespace

std::vector<double> to_common_unit(const Scene& scene, const std::vector<std::string>& reference_units,
                                   std::vector<std::string>& units) {
  std::vector<double> out(units.size(), 1.0);
  if (scene.tilt) to_unit_of_tilt(scene, units, out);
  if (!seen_alike(scene)) return out;
  Stated common;
  for (std::size_t j = 0; scene.reference && j < reference_units.size(); ++j) {
    const Stated one = {scene.reference->channels[j], reference_units[j]};
    if (common.unit.empty()) common = one;
    if (Unit::sample_factor(one.unit, common.unit) != 1)
      refuse_pair(scene, one, common, "a mean of references in two units means nothing");
  }
  for (std::size_t i = 0; i < units.size(); ++i) {
    const Stated one = {scene.sensors[i].name, stated_unit(scene.sensors[i], units[i])};
    if (common.unit.empty()) common = one;
    if (one.unit.empty()) continue;
    out[i] = factor_between(scene, one, common);
    units[i] = common.unit;
  }
  return out;
}

}  // namespace libchar
