#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "libchar/core/file/log_files.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

const std::string kOutside = "move the file next to the scene, or allow it with `allow_outside`";

// One name of a file in a scene, and where it stood, for refusals.
struct Named {
  const std::string& text;
  const std::string& where;
  const std::string& key;
  fs::path root = {};  ///< folder of the scene

  bool own_folder(const fs::path& whole) const {
    std::error_code none;
    return fs::equivalent(whole, root, none);
  }
  Refusal refusal(const char* code) const { return input_error(code, where).about(key).got(text); }
};

bool leaves(const fs::path& relative) { return !relative.empty() && *relative.begin() == ".."; }

fs::path folder_of(const std::string& scene) {
  const fs::path folder = fs::path(scene).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

// What somebody may have meant by a name that is no file.
std::string hint_for(const std::string& named, const fs::path& folder) {
  if (named.starts_with('~')) return "~ is not expanded: write the path out";
  if (named.find("://") != std::string::npos) return "nothing is read from a network: save the file next to the scene";
  if (named.find("$(") != std::string::npos || named.find_first_of("`|;") != std::string::npos)
    return "it is taken as a file name, no command is run";
  if (named.find_first_of("*?[") != std::string::npos) return "patterns are not expanded: name one file";
  if (named == "-") return "standard input cannot be replayed: name a file";
  if (named.starts_with('-')) return "it is taken as a file name, not as an option";
  return fmt::format("paths are relative to the scene's folder, {}", printable(folder.string()));
}

void check_text(const Named& named) {
  if (named.text.empty()) throw named.refusal("E0730").says("the name of a file is empty");
  if (named.text.find('\0') != std::string::npos)
    throw named.refusal("E0730").says("the name of a file holds a zero byte");
  const fs::path path(named.text);
  const bool long_part =
      std::any_of(path.begin(), path.end(), [](const fs::path& p) { return p.native().size() > 255; });
  if (named.text.size() > 4095 || long_part)
    throw named.refusal("E0730").says("a name of {} bytes is too long: 4095 are allowed, 255 between two slashes",
                                      named.text.size());
}

void check_kind(const Named& named, const fs::path& whole, SceneFolder::Kind folders) {
  const std::string shown = printable(whole.string());
  std::error_code problem;
  const fs::file_status status = fs::status(whole, problem);
  if (status.type() == fs::file_type::not_found)
    throw named.refusal("E0732").says("there is no file {}", shown).hint(hint_for(named.text, whole.parent_path()));
  if (problem) throw named.refusal("E0732").says("cannot look at {}: {}", shown, problem.message());
  const bool log =
      folders == SceneFolder::Kind::logs && !named.own_folder(whole) && detail::is_folder_of_tables(whole.string());
  if (fs::is_directory(status) && (folders == SceneFolder::Kind::any || log)) return;
  if (fs::is_directory(status)) throw named.refusal("E0733").says("{} is a folder, a file was expected", shown);
  if (!fs::is_regular_file(status))
    throw named.refusal("E0733")
        .says("{} is not a regular file (a pipe, a device, a socket)", shown)
        .hint("save its data in a file");
}

}  // namespace

std::string resolve_scene_file(const std::string& text, const SceneFolder& folder, const std::string& where,
                               const std::string& key, SceneFolder::Kind folders) {
  const Named named{text, where, key, folder_of(folder.scene)};
  check_text(named);
  const fs::path path(text), root = named.root;
  if (!folder.allow_outside && path.is_absolute())
    throw named.refusal("E0731").says("an absolute path leaves the scene's folder").hint(kOutside);
  if (!folder.allow_outside && leaves(path.lexically_normal()))
    throw named.refusal("E0731")
        .says("{} lies outside the scene's folder", printable((root / path).lexically_normal().string()))
        .hint(kOutside);
  // As the system walks it: "link/.." is not always ".".
  const fs::path whole = named_log_file((fs::path(folder.scene).parent_path() / path).string());
  std::error_code problem, root_problem;
  if (folder.may_be_absent && !fs::exists(whole, problem) && !problem) return whole.string();
  check_kind(named, whole, folders);
  const fs::path real = fs::canonical(whole, problem);
  const fs::path real_root = fs::canonical(root, root_problem);
  if (problem || root_problem)
    throw named.refusal("E0732").says("cannot look at {}: {}", printable(whole.string()),
                                      (problem ? problem : root_problem).message());
  const bool parts = detail::is_folder_of_tables(whole.string());
  for (const std::string& file : parts ? files_of_log(whole.string()) : std::vector<std::string>{real.string()})
    if (!folder.allow_outside && !detail::is_beneath(file, real_root))
      throw named.refusal("E0731")
          .says("a link leads out of the scene's folder, to {}", printable(fs::canonical(file, problem).string()))
          .hint(kOutside);
  if (detail::is_of_the_kernel(real))
    throw named.refusal("E0733").says("{} is not a recorded file", printable(real.string()));
  if (fs::equivalent(whole, folder.scene, problem)) throw named.refusal("E0734").says("the scene names itself as data");
  return whole.string();
}

namespace {

/// Without links and dots, as far as it exists and can be looked at; the folder we are in may be gone.
fs::path whole_path(const fs::path& path, std::error_code& problem) {
  const fs::path absolute = fs::absolute(path, problem);
  const fs::path whole = problem ? fs::path() : fs::weakly_canonical(absolute, problem);
  return problem ? path.lexically_normal() : whole;
}

}  // namespace

std::string path_for_scene(const std::string& file, const std::string& scene) {
  std::error_code problem;
  const fs::path root = whole_path(folder_of(scene), problem);
  const fs::path target = problem ? root : whole_path(file, problem);
  if (problem) throw input_error("E0732", scene).says("cannot look at {}: {}", printable(file), problem.message());
  const fs::path relative = target.lexically_relative(root);
  const std::string name = relative.empty() || leaves(relative) ? target.string() : relative.string();
  if (first_invalid_utf8(name) != std::string::npos || name.find('\0') != std::string::npos)
    throw output_error("E0745", scene)
        .says("a file whose name is not UTF-8 cannot be named in a scene")
        .got(name)
        .hint("rename it");
  return name;
}

void refuse_scene_outputs(const Scene& scene, const std::vector<std::string>& outputs) {
  std::vector<std::string> inputs = scene.files;
  inputs.push_back(scene.file);
  if (!scene.recording.empty()) inputs.push_back(scene.recording);
  if (scene.reference && scene.reference->recording) inputs.push_back(*scene.reference->recording);
  std::set<std::string> seen;
  for (const std::string& output : outputs) {
    for (const std::string& input : inputs) refuse_same_file(input, output);
    std::error_code problem;
    const fs::path whole = whole_path(output, problem);
    bool twice = !seen.insert(problem ? output : whole.string()).second;
    for (const std::string& other : outputs)  // two names of one existing file
      twice = twice || (&other < &output && fs::equivalent(other, output, problem) && !problem);
    if (twice) throw output_error("E0746", output).says("two outputs are one file").hint("give each a name of its own");
  }
}

}  // namespace libchar
