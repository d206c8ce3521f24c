// make_replay_report KIND|SCENE FOLDER: writes the reports of a synthetic replay, or of a scene,
// for the browser test and for whoever wants to look at a page.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "libchar/scene/scene_file.hpp"
#include "tests/report/synthetic_replay.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string kind = argv[1], folder = argv[2];
  try {
    const auto result = kind.ends_with(".yaml") ? libchar::replay(libchar::read_scene_file(kind, {true}))
                                                : test::synthetic_replay_of_kind(kind);
    std::filesystem::create_directories(folder);
    libchar::write_whole_file(folder + "/report.html", libchar::replay_html(result), true);
    libchar::write_whole_file(folder + "/report.json", libchar::dump_json(libchar::replay_json(result)), true);
    libchar::write_whole_file(folder + "/report.md", libchar::replay_markdown(result), true);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_replay_report: %s\n", error.what());
    return 1;
  }
}
