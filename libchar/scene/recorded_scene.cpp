#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "libchar/core/file/log_files.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNamesShown = 24;

std::string list_of(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), kNamesShown);
  return fmt::format("{}{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                     shown < names.size() ? ", …" : "");
}

// A name without the number that tells it from those of its kind: imu of imu2, nothing of a bare number or letter.
std::string kind_of(std::string name) {
  std::erase_if(name, [](char c) { return c >= '0' && c <= '9'; });
  return name.size() > 1 ? name : "";
}

std::vector<std::string> names_at_head(const std::string& file, ReadOptions reading) {
  reading.units.clear();
  std::vector<std::string> names;
  for (const Channel& channel : read_log_head(file, reading).channels) names.push_back(channel.name);
  return names;
}

// What each source of a long table has.
std::vector<std::string> columns_of_sources(const SensorRecording& r) {
  ReadOptions reading = r.reading;
  if (reading.kinds.group_by.empty()) return {};
  reading.channels = {"!" + std::exchange(reading.kinds.group_by, "")};
  return names_at_head(r.file, std::move(reading));
}

// Three axes are in one unit, too: only the caller knows which channels see one input. Sources that differ by a number
// only and have one column each do.
std::vector<std::string> sensors_or_ask(const SensorRecording& r) {
  if (!r.sensors.empty()) return r.sensors;
  const std::vector<std::string> names = names_at_head(r.file, r.reading), columns = columns_of_sources(r);
  const std::string kind = kind_of(names.at(0));
  if (columns.size() == 1 &&
      std::all_of(names.begin(), names.end(), [&](const std::string& name) { return kind_of(name) == kind; }))
    return {"*"};
  std::string pattern = columns.empty() ? "gyro*" : columns.size() == 1 ? "*" : "*_" + columns[0];
  const std::size_t field = is_pattern(r.reading.topic) ? names[0].rfind('/') : std::string::npos;
  if (field != std::string::npos) pattern = "*" + names[0].substr(field);
  throw usage_error("E0749", "`sensors`")
      .says("which channels measure one quantity?")
      .hint("{} has {}; patterns such as '{}' name several", printable(r.file), printable(list_of(names)),
            printable(pattern));
}

std::vector<std::string> together(const std::vector<std::vector<std::string>>& parts, const char* option) {
  std::vector<std::string> out;
  std::set<std::string> seen;
  for (const auto& part : parts)
    for (const std::string& name : part) {
      if (!seen.insert(name).second) throw usage_error("E0749", option).says("a channel is named twice").got(name);
      out.push_back(name);
    }
  return out;
}

struct Chosen {
  std::vector<std::string> sensors, reference;
};

// Names first: a pattern for the sensors leaves the reference out.
Chosen choose_columns(const SensorRecording& r) {
  Chosen out;
  const bool own_log = !r.reference_file.empty();
  if (!r.reference.empty())
    out.reference =
        together(channel_names(own_log ? r.reference_file : r.file, own_log ? ReadOptions{} : r.reading, r.reference),
                 "`reference`");
  out.sensors = together(
      channel_names(r.file, r.reading, sensors_or_ask(r), own_log ? std::vector<std::string>{} : out.reference),
      "`sensors`");
  if (out.sensors.size() > kMostSensors)
    throw usage_error("E0749", "`sensors`")
        .says("{} sensors are more than the {} that a scene may have", out.sensors.size(), kMostSensors);
  for (const std::string& name : out.reference)
    if (!own_log && std::find(out.sensors.begin(), out.sensors.end(), name) != out.sensors.end())
      throw usage_error("E0749", "`reference`")
          .says("the reference is one of the sensors: its own error would be hidden")
          .got(name)
          .hint("name sensors and reference apart");
  return out;
}

// Those of `names`, with their units.
std::vector<Channel> channels_of(const std::string& file, ReadOptions reading, const std::vector<std::string>& names) {
  if (reading.names.empty()) reading.channels = names;
  std::vector<Channel> out;
  for (const Channel& channel : read_log_head(file, reading).channels)
    if (std::find(names.begin(), names.end(), channel.name) != names.end()) out.push_back(channel);
  return out;
}

// Where two channels say their units, one is converted to the other (a replay does it) or they are refused.
void check_units(const SensorRecording& r, const Chosen& chosen) {
  std::vector<std::string> here = chosen.sensors;
  if (r.reference_file.empty()) here.insert(here.end(), chosen.reference.begin(), chosen.reference.end());
  std::vector<Channel> all = channels_of(r.file, r.reading, here);
  if (!r.reference_file.empty())
    for (Channel& channel : channels_of(r.reference_file, {}, chosen.reference)) all.push_back(std::move(channel));
  std::erase_if(all, [](const Channel& channel) { return channel.unit.empty(); });
  for (const Channel& channel : all)
    if (!Unit::sample_factor(channel.unit, all[0].unit))
      throw usage_error("E0749", r.file)
          .says("{} is in {}, and {} in {}: they are not one quantity", printable(all[0].name, 40),
                printable(all[0].unit, 40), printable(channel.name, 40), printable(channel.unit, 40))
          .hint(
              "choose others with `sensors`, say what they are in with `units`, or give each a scale and a unit in a "
              "scene file");
}

void add_model(SceneSensor& sensor, const std::string& file, Scene& scene) {
  sensor.model = read_model_file(file);
  if (std::find(scene.files.begin(), scene.files.end(), file) == scene.files.end()) scene.files.push_back(file);
}

void add_models(const SensorRecording& r, Scene& scene) {
  if (!r.models_folder.empty()) {
    refuse_interrupted(r.models_folder);
    for (SceneSensor& sensor : scene.sensors) {
      const fs::path file = fs::path(r.models_folder) / (file_name_for(sensor.name) + ".sensor.yaml");
      std::error_code ignored;  // what is there and cannot be looked at is told when it is opened
      if (fs::status(file, ignored).type() == fs::file_type::not_found)
        throw usage_error("E0749", "`models`")
            .says("there is no model of sensor {}", printable(sensor.name, 40))
            .got(file.string())
            .hint("characterize writes one for each channel into its folder");
      add_model(sensor, file.string(), scene);
    }
  }
  for (const auto& [name, file] : r.models) {
    const auto sensor = std::find_if(scene.sensors.begin(), scene.sensors.end(),
                                     [&name = name](const auto& s) { return s.name == name; });
    if (sensor == scene.sensors.end())
      throw usage_error("E0749", "`model`").says("there is no sensor of this name among those chosen").got(name);
    add_model(*sensor, file, scene);
  }
}

}  // namespace

Scene scene_from_recording(const SensorRecording& r) {
  if (read_once(r.file))
    throw usage_error("E0749", r.file)
        .says("a replay reads its recording several times, and this can be read once only")
        .hint("save it in a file");
  if (r.reference.empty() && !r.reference_file.empty())
    throw usage_error("E0749", "`reference_log`").says("which of its channels is the reference?").got(r.reference_file);
  const Chosen chosen = choose_columns(r);
  check_units(r, chosen);
  Scene scene;
  scene.file = r.scene_file.empty() ? r.file : r.scene_file;
  scene.name = stem_of_log(r.file);
  scene.recording = r.file;
  scene.reading = r.reading;
  scene.files.push_back(r.file);
  for (const std::string& name : chosen.sensors) {
    SceneSensor sensor;
    sensor.name = sensor.channel = name;
    scene.sensors.push_back(std::move(sensor));
  }
  if (!chosen.reference.empty()) {
    SceneReference& reference = scene.reference.emplace();
    reference.channels = chosen.reference;
    reference.mean = chosen.reference.size() > 1;
    if (!r.reference_file.empty()) {
      reference.recording = r.reference_file;
      scene.files.push_back(r.reference_file);
    }
  }
  add_models(r, scene);
  return scene;
}

}  // namespace libchar
