// Any bytes as a scene: JSON when the first byte is odd, YAML else. What is read must be written,
// and what is written must read back to the same text.

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_file.hpp"

using namespace libchar;

namespace {

// Two small files that a scene can name, in memory, one folder a process.
const std::string& folder() {
  static const std::string& path = *new std::string([] {  // outlives the handler of exit
    std::string made = "/dev/shm/libchar-scene-fuzz-" + std::to_string(::getpid());
    std::filesystem::create_directory(made);
    std::ofstream(made + "/log.csv") << "t[s],a,b\n0,1,2\n0.01,1,2\n0.02,1,2\n";
    std::ofstream(made + "/m.yaml") << "format: sensor-model\nversion: 1\nrate_hz: 100\n";
    std::atexit([] { std::filesystem::remove_all(folder()); });
    return made;
  }());
  return path;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  const std::string file = folder() + (data[0] % 2 == 1 ? "/s.json" : "/s.yaml");
  std::string written;
  try {
    const Scene scene = parse_scene(text, file);
    if (scene.sensors.size() > 20) return 0;
    written = scene_yaml(scene);
  } catch (const Error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
    return 0;
  }
  std::string again;
  try {
    again = scene_yaml(parse_scene(written, folder() + "/s.yaml"));
  } catch (const Error& error) {
    again = error.what();
  }
  if (again != written) {
    std::fprintf(stderr, "written:\n%s\nagain:\n%s\n", written.c_str(), again.c_str());
    std::abort();
  }
  return 0;
}
