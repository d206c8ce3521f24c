// When things happen in a scene: windows, faults, what a simulated recording holds.

#include "libchar/scene/detail/scene_times.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "libchar/core/error.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "libchar/scene/detail/scene_parts.hpp"
#include "libchar/scene/detail/scene_sensors.hpp"
#include "libchar/scene/detail/scene_simulation.hpp"
#include "libchar/scene/detail/scene_values.hpp"
#include "libchar/scene/text/preparation_check.hpp"

namespace libchar {
namespace {

void check_align_terms(const MapReader& at, const SceneAlign& align) {
  for (const std::string& term : align.terms)
    if (std::find(std::begin(kAlignTerms), std::end(kAlignTerms), term) == std::end(kAlignTerms))
      refuse_scene("E0748",
                   at,
                   "terms",
                   fmt::format("{} is no term of an alignment", printable(term, 40)),
                   fmt::format("there are {}", fmt::join(kAlignTerms, ", ")));
}

SceneAlign align_of(const MapReader& top, const Scene& scene) {
  const MapReader at = top.map("align", keys_of(align_fields()));
  SceneAlign align;
  read_fields(align_fields(), at, align);
  check_align_terms(at, align);
  if (!at.has("learn")) {
    align.learn = scene.learning ? "learning" : "run";
  } else if (at.require("learn").kind == Document::Kind::list) {
    align.window = window_of(at, "learn");
  } else {
    align.learn = at.word("learn", {"rest", "learning", "run"});
    if ((align.learn == "rest" && !scene.rest) || (align.learn == "learning" && !scene.learning))
      refuse_scene("E0748",
                   at,
                   "learn",
                   "the scene has no such window",
                   "learn: [from, to], or the window's own key");
  }
  if (align.by == "reference" && !scene.reference)
    refuse_scene("E0748", at, "by", "the scene has no reference", "by: sensors");
  if (align.choose && (!scene.reference || align.by == "sensors"))
    refuse_scene("E0748", at, "choose", "a reference judges what pays", "terms: […] without one");
  if (scene.tilt)
    refuse_scene("E0748", top, "align", "the sensors of a tilt measure different quantities");
  return align;
}

void check_preparation(const MapReader& top, const Scene& scene) {
  const ScenePreparation& p = scene.preparation;
  if (top.has("band_hz") && top.has("high_pass_hz"))
    refuse_scene(
        "E0735", top, "high_pass_hz", "band_hz has a high-pass already", "give one of them");
  const char* key = p.to_hz != 0          ? "band_hz"
                    : p.filters()         ? "high_pass_hz"
                    : p.detrend != "none" ? "detrend"
                                          : "reference";
  if (const std::string why = why_not_prepared(scene); !why.empty())
    refuse_scene("E0750", top, key, why);
}

// Either every sensor names as many other axes, or none does.
void check_cross(const MapReader& top, const SensorIndex& index, const Scene& scene) {
  for (std::size_t i = 0; i < scene.sensors.size(); ++i)
    if (scene.sensors[i].cross.size() != scene.sensors[0].cross.size())
      refuse_scene_value("E0748",
                         top,
                         *index.places[i].node,
                         index.places[i].path,
                         fmt::format("sensor {} names {} other axes, and the first one {}",
                                     printable(scene.sensors[i].name, 40),
                                     scene.sensors[i].cross.size(),
                                     scene.sensors[0].cross.size()),
                         "cross: the same axes of each device, in one order");
}

SensorFault fault_of(const MapReader& at, const Scene& scene, const SensorIndex& index) {
  SensorFault fault;
  fault.sensor = sensor_index(at, "sensor", scene, index);
  FaultText text;
  read_fields(fault_fields(), at, text);
  fault.kind = text.kind;
  const bool valueless = is_valueless(fault.kind);
  if (valueless && at.has("value"))
    refuse_scene(
        "E0739", at, "value", fmt::format("a fault of kind {} has no value", name_of(fault.kind)));
  const bool size = fault.kind == FaultKind::noise || fault.kind == FaultKind::saturation;
  if (!valueless) fault.value = at.number("value", size ? kNotNegative : kAnyNumber);
  fault.from_s = text.from_s;
  if (text.to_s) fault.to_s = *text.to_s;
  if (!(fault.from_s < fault.to_s))
    refuse_scene("E0740", at, "to_s", "a fault lasts from a time to a later one");
  return fault;
}

std::vector<SensorFault> faults_of(const MapReader& from,
                                   const Scene& scene,
                                   const SensorIndex& index) {
  std::vector<SensorFault> out;
  if (!from.has("faults")) return out;
  const auto& list = from.list("faults");
  for (std::size_t i = 0; i < list.size(); ++i)
    out.push_back(fault_of(MapReader(list[i],
                                     from.file(),
                                     fmt::format("{}[{}]", from.path_of("faults"), i),
                                     keys_of(fault_fields())),
                           scene,
                           index));
  return out;
}

// Is a true input, or the temperature, read from a log?
bool has_recorded_signal(const Document& node) {
  const DocumentEntry* kind = node.find("kind");
  if (kind != nullptr && kind->value.text == "recording") return true;
  return std::any_of(node.list.begin(), node.list.end(), has_recorded_signal) ||
         std::any_of(node.map.begin(), node.map.end(), [](const DocumentEntry& entry) {
           return has_recorded_signal(entry.value);
         });
}

// The simulation that `simulate` began with: the same sensors and faults, and its own rows h.
std::optional<ArraySimulation> simulation_again(const MapReader& at,
                                                const SimulatedFrom& from,
                                                const SceneFolder& folder,
                                                Scene& scene) {
  if (!folder.may_be_absent && has_recorded_signal(at.require("simulate"))) return std::nullopt;
  SceneFolder files = folder;
  files.may_be_absent = false;
  ArraySimulation out = scene_simulation_of(at, files, scene);
  out.seed = from.seed;
  out.oversampling = from.oversampling;
  out.deterministic = from.deterministic;
  out.faults = from.faults;
  const std::size_t inputs = out.truth.size();
  if (!from.rows.empty() && from.rows.size() != inputs * scene.sensors.size())
    refuse_scene("E0741",
                 at,
                 "rows",
                 fmt::format("expected {} weights, one a sensor and true input, found {}",
                             inputs * scene.sensors.size(),
                             from.rows.size()));
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const SceneSensor& sensor = scene.sensors[i];
    out.sensors.push_back({sensor.name, sensor.model.value_or(SensorModel{}), sensor.h});
    if (!from.rows.empty())
      out.sensors[i].h.assign(from.rows.begin() + static_cast<std::ptrdiff_t>(i * inputs),
                              from.rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * inputs));
  }
  try {
    check(out);
  } catch (const Error& error) {
    Problem problem = error.problem();
    problem.where = at.where(at.require("simulate"));
    throw Error(problem);
  }
  return out;
}

SimulatedFrom simulated_of(const MapReader& top,
                           const SceneFolder& folder,
                           Scene& scene,
                           const SensorIndex& index) {
  if (scene.simulate)
    refuse_scene("E0735", top, "simulated", "tells what a recording holds; this scene has none");
  const MapReader at = top.map("simulated", keys_of(simulated_fields()));
  SimulatedFrom from;
  read_fields(simulated_fields(), at, from);
  check_oversampling(at, from.oversampling);
  from.faults = faults_of(at, scene, index);
  if (at.has("simulate")) from.simulation = simulation_again(at, from, folder, scene);
  return from;
}

}  // namespace

void read_scene_times(const MapReader& top,
                      const SceneFolder& folder,
                      const SensorIndex& index,
                      Scene& scene) {
  read_fields(scene_time_fields(), top, scene);
  scene.faults = faults_of(top, scene, index);
  check_cross(top, index, scene);
  check_preparation(top, scene);
  if (top.has("align")) scene.align = align_of(top, scene);
  if (top.has("simulated")) scene.simulated = simulated_of(top, folder, scene, index);
}

}  // namespace libchar
