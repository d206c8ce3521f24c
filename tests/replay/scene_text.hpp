#pragma once
// A folder with what the scenes of the tests name, and the reading of one.

#include <fstream>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_file.hpp"
#include "tests/support/shared.hpp"

namespace test {

struct SceneBench {
  SceneBench() {
    put("log.csv", "t[s],a,b,c,truth\n0,1,2,3,2\n0.01,1,2,3,2\n0.02,1,2,3,2\n");
    put("station.csv", "t[s],pm25\n0,2\n1,2\n2,2\n");
    put("motion.csv", "t[s],rate,angle\n0,1,5\n0.01,2,6\n0.02,3,7\n0.03,4,8\n");
    put("gyro.sensor.yaml",
        "format: sensor-model\nversion: 1\nunit: rad/s\nrate_hz: 100\ndensity: one-sided\n"
        "white_noise: {value: 0.3, unit: \"deg/s/√Hz\"}\nbias: {value: 0.1, spread: 0.01}\n");
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  libchar::Scene read(const std::string& text, const std::string& name = "s.yaml", bool allow_outside = false) const {
    put(name, text);
    return libchar::read_scene_file(path(name), {allow_outside});
  }
  /// The refusal without the folder in front; empty when the scene is read.
  std::string refusal(const std::string& text, const std::string& name = "s.yaml", bool allow_outside = false) const {
    try {
      read(text, name, allow_outside);
    } catch (const libchar::Error& error) {
      const std::string said = error.what(), front = folder.path().string() + "/";
      return said.starts_with(front) ? said.substr(front.size()) : said;
    }
    return "";
  }
  TemporaryFolder folder;
};

}  // namespace test
