// Fusion algorithms on one scene: its recording is simulated, so the truth is known.
#include <cstdio>

#include "libchar/libchar.hpp"

int main() {
  const libchar::Scene scene = libchar::read_scene_file("fixtures/scenes/rv-2.5-tilt.yaml");
  libchar::ReplayOptions options;
  options.allan = false;
  const libchar::ReplayResult result = libchar::replay(scene, options);
  for (const libchar::AlgorithmResult& a : result.algorithms)
    if (a.ran) std::printf("%s: RMSE %.2g rad\n", a.label.c_str(), a.rmse);
  libchar::write_whole_file("library-replay.html", libchar::replay_html(result), true);
}
