// Type names come from logs of unknown origin: only letters, digits and '_' become a part of a path.
#include "libchar/log/ros/messages/message_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>

#include "libchar/core/refusal.hpp"
#include "libchar/log/ros/messages/message_definition.hpp"

namespace libchar {
namespace {

namespace files = std::filesystem;

constexpr std::uintmax_t kLargest = 1U << 20U;  // bytes of a definition
constexpr std::size_t kMostTypes = 1000;        // of one topic

struct TypeName {
  std::string package, name;
};

TypeName type_name(std::string_view type) {
  const std::string plain = plain_type_name(type);
  const std::size_t slash = plain.find('/');
  if (slash == std::string::npos || plain.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                            "0123456789_/") != std::string::npos)
    return {};
  return {plain.substr(0, slash), plain.substr(slash + 1)};
}

std::string text_of(const files::path& path) {
  std::error_code none;
  if (!files::is_regular_file(path, none) || files::file_size(path, none) > kLargest || none) return "";
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// `type` and, behind parting lines, what it uses and `text_for` knows.
std::string with_parts(std::string_view type, const std::function<std::string(const TypeName&)>& text_for) {
  const TypeName first = type_name(type);
  if (first.name.empty()) return "";
  std::string out = text_for(first);
  if (out.empty()) return out;
  MessageTypes types;
  std::set<std::string> seen = {plain_type_name(type)};
  std::vector<std::string> wanted;
  const auto want_parts_of = [&](const std::string& name, const std::string& text) {
    if (!add_message_types(name, text, false, types).empty()) return;
    for (const MessageField& field : types.at(name).fields)
      if (!field.type.empty() && seen.insert(field.type).second) wanted.push_back(field.type);
  };
  want_parts_of(*seen.begin(), out);
  while (!wanted.empty() && seen.size() < kMostTypes) {
    const std::string name = std::move(wanted.back());
    wanted.pop_back();
    const std::string text = text_for(type_name(name));
    if (text.empty()) continue;  // of a common type, which is known
    out += fmt::format("\n{:=<80}\nMSG: {}\n{}", "", name, text);
    want_parts_of(name, text);
  }
  return out;
}

}  // namespace

MessageFiles::MessageFiles(const std::string& folder) {
  if (folder.empty()) return;
  constexpr int kDeepest = 12;
  std::error_code problem;
  files::recursive_directory_iterator at(folder, files::directory_options::skip_permission_denied, problem), end;
  for (; !problem && at != end; at.increment(problem)) {
    if (at.depth() >= kDeepest) at.disable_recursion_pending();
    if (at->path().extension() == ".msg") by_name_[at->path().stem().string()].push_back(at->path());
  }
  if (!by_name_.empty()) return;
  throw usage_error("E0450", folder)
      .says(problem ? problem.message() : "no .msg file in this folder and those below it")
      .hint("`msg` takes a folder of ROS packages, or one package of them");
}

std::string MessageFiles::given(std::string_view type) const {
  return with_parts(type, [this](const TypeName& wanted) -> std::string {
    const auto found = by_name_.find(wanted.name);
    if (found == by_name_.end()) return "";
    const auto of_package = [&](const files::path& path) {
      return std::any_of(path.begin(), path.end(), [&](const files::path& part) { return part == wanted.package; });
    };
    const auto& paths = found->second;
    const auto exact = std::find_if(paths.begin(), paths.end(), of_package);
    // A folder that is not called as its package, if nothing else has the name.
    return exact != paths.end() ? text_of(*exact) : paths.size() == 1 ? text_of(paths.front()) : "";
  });
}

std::string MessageFiles::installed(std::string_view type) {
  std::vector<files::path> prefixes;
  const char* const listed = std::getenv("AMENT_PREFIX_PATH");
  for (std::string_view rest = listed != nullptr ? listed : ""; !rest.empty();) {
    const std::string_view one = rest.substr(0, rest.find(':'));
    if (!one.empty()) prefixes.emplace_back(one);
    rest.remove_prefix(std::min(one.size() + 1, rest.size()));
  }
  std::error_code none;
  for (files::directory_iterator at("/opt/ros", none), end; !none && at != end; at.increment(none))
    prefixes.push_back(at->path());
  return with_parts(type, [&](const TypeName& wanted) -> std::string {
    for (const files::path& prefix : prefixes)
      if (std::string text = text_of(prefix / "share" / wanted.package / "msg" / (wanted.name + ".msg")); !text.empty())
        return text;
    return "";
  });
}

}  // namespace libchar
