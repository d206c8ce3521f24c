// The block `sensors` of a scene file.

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "libchar/scene/detail/scene_values.hpp"

namespace libchar {
namespace {

const std::string kNeedsModel = "a simulated sensor needs a model";
const std::string kModelHint = "model: FILE.sensor.yaml, the keys of a model, or none for a perfect sensor";

// The channel that an entry of the list means; empty: it says none.
std::string channel_word(const Document& entry) {
  if (is_scalar(entry)) return entry.text;
  const DocumentEntry* found = entry.find("channel");
  if (found == nullptr) found = entry.find("name");
  return found != nullptr && is_scalar(found->value) ? found->value.text : "";
}

// Channels of the scene's own recording that are its reference: no pattern means them.
std::vector<std::string> reference_words(const MapReader& top) {
  const DocumentEntry* reference = top.node().find("reference");
  if (reference == nullptr || reference->value.find("recording") != nullptr) return {};
  const DocumentEntry* channels = reference->value.find("channels");
  const Document& node = channels != nullptr ? channels->value : reference->value;
  std::vector<std::string> out;
  for (const Document& name : is_scalar(node) ? std::vector<Document>{node} : node.list) out.push_back(name.text);
  return out;
}

class SensorsReader {
 public:
  SensorsReader(const MapReader& top, const SceneFolder& folder, Scene& scene)
      : top_(top), folder_(folder), scene_(scene) {}

  SensorIndex read() {
    const auto& list = top_.list("sensors");
    if (list.empty()) throw scene_refusal("E0736", top_, "sensors").says("expected at least one sensor");
    if (list.size() > kMostSensors) refuse_number(list.size());
    match_patterns(list);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const auto found = channels_.find(channel_word(list[i]));
      matched_ = found == channels_.end() ? nullptr : &found->second;
      sensor(list[i], fmt::format("sensors[{}]", i));
    }
    check_names();
    return std::move(index_);
  }

 private:
  using Place = SensorIndex::Place;

  Refusal refusal(const char* code, const Place& place) const {
    return scene_refusal_at(code, top_, *place.node, place.path);
  }

  [[noreturn]] void refuse_number(std::uint64_t number) const {
    throw scene_refusal("E0736", top_, "sensors")
        .says("{} sensors are more than the {} that a scene may have", number, kMostSensors);
  }

  // Of a recording, and where there is none, the recording is not looked at.
  void match_patterns(const std::vector<Document>& list) {
    if (scene_.simulate) return;
    std::vector<std::string> patterns, named = reference_words(top_);
    for (const Document& entry : list) {
      const std::string word = channel_word(entry);
      (is_pattern(word) ? patterns : named).push_back(word);
    }
    if (patterns.empty()) return;
    try {
      const auto found = channel_names(scene_.recording, scene_.reading, patterns, named);
      for (std::size_t k = 0; k < patterns.size(); ++k) channels_.emplace(patterns[k], found[k]);
    } catch (const Error& error) {
      if (error.problem().kind != ErrorKind::usage) throw;
      for (std::size_t i = 0; i < list.size(); ++i)
        if (channel_word(list[i]) == error.problem().got)
          throw scene_refusal_at("E0738", top_, list[i], fmt::format("sensors[{}]", i))
              .says("{} in {}", error.problem().what, scene_.recording)
              .hint(error.problem().hint);
      throw;
    }
  }

  // One sensor, or one a channel that the pattern stands for.
  void add_matched(SceneSensor sensor, const Place& place) {
    if (matched_ == nullptr) return add(sensor, place);
    for (const std::string& channel : *matched_) {
      sensor.name = sensor.channel = channel;
      add(sensor, place);
    }
  }

  void sensor(const Document& node, const std::string& path) {
    SceneSensor sensor;
    if (is_scalar(node)) {
      if (scene_.simulate) throw refusal("E0743", {&node, path}).says(kNeedsModel).hint(kModelHint);
      sensor.name = sensor.channel = node.text;
      return add_matched(sensor, {&node, path});
    }
    const MapReader at(node, folder_.scene, path, keys_of(sensor_fields()));
    const char* named = at.has("name") || !at.has("channel") ? "name" : "channel";
    const Place place{&at.require(named), at.path_of(named)};
    read_fields(sensor_fields(), at, sensor);
    sensor.name = at.text(named);
    sensor.channel = at.text_or("channel", sensor.name);
    if (at.has("channel")) check_scene_text(top_, at.require("channel"), at.path_of("channel"), scene_);
    if (sensor.h.empty()) throw scene_refusal("E0741", at, "h").says("expected one weight a true input");
    if (at.has("model")) sensor.model = model(at);
    if (sensor.scale == 0) at.refuse("scale", "a scale of zero leaves nothing of the samples");
    if (!(std::abs(sensor.scale) >= 1e-100 && std::abs(sensor.scale) <= 1e100))
      at.refuse("scale", "a scale beyond 10¹⁰⁰ or below 10⁻¹⁰⁰ leaves no room for squares");
    check_simulated(at);
    if (at.has("count")) return devices(sensor, at, place);
    if (matched_ == nullptr || !at.has("name") || !at.has("channel")) return add_matched(sensor, place);
    if (matched_->size() > 1)
      throw refusal("E0737", place)
          .says("one name for {} channels", matched_->size())
          .hint("leave name out: each sensor has its channel's");
    sensor.channel = matched_->front();
    add(sensor, place);
  }

  void check_simulated(const MapReader& at) const {
    if (!scene_.simulate) return;
    if (at.has("scale")) at.refuse("scale", "the samples of a simulation are used as they are");
    if (at.has("unit")) at.refuse("unit", "the unit of a simulated sensor is its model's");
    if (at.has("channel")) at.refuse("channel", "a simulated sensor's channel has its name");
    if (!at.has("model")) throw scene_refusal("E0743", at, "model").says(kNeedsModel).hint(kModelHint);
  }

  // NAME1 … NAMEn from one model.
  void devices(SceneSensor sensor, const MapReader& at, const Place& place) {
    if (!scene_.simulate) at.refuse("count", "a recording has the sensors it has", "name each of them");
    const std::uint64_t count = at.count("count");
    if (count == 0) at.refuse("count", "expected at least one device");
    if (count > kMostSensors) refuse_number(count);
    const std::string name = sensor.name;
    for (std::uint64_t i = 1; i <= count; ++i) {
      sensor.name = sensor.channel = name + std::to_string(i);
      add(sensor, place);
    }
  }

  void add(const SceneSensor& sensor, const Place& place) {
    if (scene_.sensors.size() >= kMostSensors) refuse_number(scene_.sensors.size() + 1);
    if (place.node->kind == Document::Kind::null || sensor.name.empty())
      throw refusal("E0737", place).says("a sensor needs a name");
    check_scene_text(top_, *place.node, place.path, scene_);
    index_.places.push_back(place);
    scene_.sensors.push_back(sensor);
  }

  std::optional<SensorModel> model(const MapReader& at) {
    const Document& node = at.require("model");
    if (!is_scalar(node)) return sensor_model_of(node, folder_.scene, at.path_of("model"));
    if (node.text == "none") return std::nullopt;
    const std::string path = scene_file_of(at, "model", folder_, scene_);
    const auto known = models_.find(path);
    if (known != models_.end()) return known->second;
    return models_.emplace(path, read_model_file(path)).first->second;
  }

  // Equal names are refused; names that differ by capitals only are counted.
  void check_names() {
    std::map<std::string, std::size_t> small;
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      const std::string& name = scene_.sensors[i].name;
      if (!index_.by_name.emplace(name, i).second)
        throw refusal("E0737", index_.places[i]).says("two sensors have the name {}", printable(name, 40));
      if (!small.emplace(ascii_lower(name), i).second)
        scene_.warnings.add("case_clash", "names of sensors differ by capitals only",
                            top_.where(*index_.places[i].node));
    }
  }

  const MapReader& top_;
  const SceneFolder& folder_;
  Scene& scene_;
  SensorIndex index_;
  std::map<std::string, SensorModel> models_;
  std::map<std::string, std::vector<std::string>> channels_;  // that patterns stand for
  const std::vector<std::string>* matched_ = nullptr;         // of an entry with a pattern
};

}  // namespace

SensorIndex read_scene_sensors(const MapReader& top, const SceneFolder& folder, Scene& scene) {
  return SensorsReader(top, folder, scene).read();
}

std::size_t sensor_index(const MapReader& at, std::string_view key, const Scene& scene, const SensorIndex& index) {
  const std::string name = at.text(key);
  const auto found = index.by_name.find(name);
  if (found != index.by_name.end()) return found->second;
  std::vector<std::string> names;
  for (const SceneSensor& sensor : scene.sensors) names.push_back(sensor.name);
  return index_of_name(at, key, name, names, "a sensor of this scene");
}

}  // namespace libchar
