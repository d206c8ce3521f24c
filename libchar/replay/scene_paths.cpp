#include "libchar/replay/scene_paths.hpp"

#include <filesystem>

#include "libchar/core/error.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& where,
                         std::string what,
                         const std::string& got,
                         std::string hint = "") {
  throw Error({ErrorKind::input, "E0560", where, std::move(what), got, std::move(hint)});
}

bool leaves(const fs::path& relative) {
  return !relative.empty() && *relative.begin() == "..";
}

// What somebody may have meant by a name that is no file.
std::string hint_for(const std::string& named) {
  if (named.starts_with('~')) return "~ is not expanded: write the path out";
  if (named.find_first_of("*?[") != std::string::npos)
    return "patterns are not expanded: name one file";
  if (named.find("$(") != std::string::npos || named.find('`') != std::string::npos)
    return "commands are not run: name a file";
  if (named == "-") return "standard input cannot be replayed: name a file";
  return "paths are relative to the scene's folder";
}

void check_text(const std::string& named, const std::string& where) {
  if (named.empty()) refuse(where, "an empty path", "");
  if (named.find('\0') != std::string::npos) refuse(where, "a path holds a zero byte", named);
  if (named.size() > 4096) refuse(where, "a path is longer than 4096 bytes", named);
  if (named.find("://") != std::string::npos)
    refuse(where,
           "is an address: nothing is read from a network",
           named,
           "save the file beside the scene");
}

}  // namespace

std::string resolve_scene_file(const std::string& named,
                               const SceneFolder& folder,
                               const std::string& where) {
  check_text(named, where);
  const std::string outside = "move the file beside the scene, or allow it with --allow-outside";
  const fs::path path(named), root = fs::path(folder.scene).parent_path();
  if (!folder.allow_outside && path.is_absolute())
    refuse(where, "an absolute path leaves the scene's folder", named, outside);
  if (!folder.allow_outside && leaves(path.lexically_normal()))
    refuse(where, "the path leaves the scene's folder", named, outside);
  const fs::path whole = (root / path).lexically_normal();
  std::error_code problem;
  const fs::file_status status = fs::status(whole, problem);
  if (status.type() == fs::file_type::not_found)
    refuse(where, "there is no file " + whole.string(), named, hint_for(named));
  if (problem) refuse(where, "cannot look at " + whole.string() + ": " + problem.message(), named);
  if (fs::is_directory(status)) refuse(where, "is a folder, a file was expected", named);
  if (!fs::is_regular_file(status)) refuse(where, "is no regular file", named);
  const fs::path real = fs::canonical(whole, problem);
  const fs::path real_root = fs::canonical(root.empty() ? fs::path(".") : root, problem);
  if (!folder.allow_outside && leaves(real.lexically_relative(real_root)))
    refuse(where, "a link leads out of the scene's folder", named, outside);
  if (fs::equivalent(whole, folder.scene, problem))
    refuse(where, "the scene names itself as data", named);
  return whole.string();
}

std::string path_for_scene(const std::string& file, const std::string& scene) {
  std::error_code problem;
  const fs::path root = fs::weakly_canonical(
      fs::path(scene).parent_path().empty() ? fs::path(".") : fs::path(scene).parent_path(),
      problem);
  const fs::path target = fs::weakly_canonical(file, problem);
  const fs::path relative = target.lexically_relative(root);
  return relative.empty() || leaves(relative) ? target.string() : relative.string();
}

}  // namespace libchar
