#include "libchar/core/output_files.hpp"

#include <signal.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "libchar/core/detail/output_journal.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/whole_file.hpp"

namespace libchar {

namespace {

void make_folder(const std::filesystem::path& folder) {
  if (folder.empty()) return;  // the folder one is in
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem)
    throw Error({ErrorKind::output,
                 "E0505",
                 folder.string(),
                 "cannot make this folder: " + problem.message(),
                 "",
                 ""});
}

bool is_document(const std::filesystem::path& path) {
  return path.extension() == ".json";
}

/// Names that a document gives as files written with it, itself among them; none of another document.
std::vector<std::string> files_of_document(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const Json document = Json::parse(file, nullptr, false);
  if (!document.is_object() || !document.contains("files") || !document["files"].is_array())
    return {};
  std::vector<std::string> names;
  for (const Json& value : document["files"])
    if (value.is_string()) names.push_back(value.get<std::string>());
  const bool itself =
      std::find(names.begin(), names.end(), path.filename().string()) != names.end();
  return itself ? names : std::vector<std::string>{};
}

/// What earlier runs wrote into the folder: plain names of regular files there.
std::set<std::string> earlier_files(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::set<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (!is_document(entry.path()) || !entry.is_regular_file(ignored)) continue;
    for (const std::string& name : files_of_document(entry.path()))
      if (name.find('/') == std::string::npos &&
          fs::symlink_status(folder / name, ignored).type() == fs::file_type::regular)
        names.insert(name);
  }
  return names;
}

/// Temporary files (NAME.tmp-PROCESS-NUMBER) that a process which is no more has left.
void remove_litter(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t mark = name.rfind(".tmp-");
    if (mark == std::string::npos || !entry.is_regular_file(ignored)) continue;
    const std::string number = name.substr(mark + 5);
    pid_t process = 0;
    const auto read = std::from_chars(number.data(), number.data() + number.size(), process);
    if (read.ec != std::errc{} || *read.ptr != '-' || process <= 0 ||
        number.find_first_not_of("-0123456789") != std::string::npos)
      continue;
    if (::kill(process, 0) != 0 && errno == ESRCH) std::filesystem::remove(entry.path(), ignored);
  }
}

std::vector<std::string> names_of(const std::vector<OutputFile>& outputs) {
  std::vector<std::string> names;
  for (const OutputFile& output : outputs)
    names.push_back(std::filesystem::path(output.path).filename().string());
  return names;
}

/// All names at once, as far as a file system can: the journal first, then what it says.
void give_names(std::vector<WholeFile>& files,
                const std::vector<std::string>& stale,
                const std::filesystem::path& folder) {
  OutputJournal journal;
  journal.remove = stale;
  for (const WholeFile& file : files)
    if (!file.temporary().empty())
      journal.rename.emplace_back(std::filesystem::path(file.temporary()).filename().string(),
                                  std::filesystem::path(file.path()).filename().string());
  write_journal(folder, journal);
  for (WholeFile& file : files) file.temporary().empty() ? file.commit() : file.hand_over();
  finish_journal(folder);
}

}  // namespace

void check_outputs(const std::vector<std::string>& paths,
                   const std::filesystem::path& folder,
                   const std::vector<std::string>& inputs,
                   bool force) {
  make_folder(folder);
  for (const std::string& path : paths) {
    for (const std::string& input : inputs) refuse_same_file(input, path);
    const WholeFile trial(path, force);  // discarded: nothing appears under the name
  }
}

std::vector<std::string> write_outputs(const std::vector<OutputFile>& outputs,
                                       const std::filesystem::path& into,
                                       const std::vector<std::string>& inputs,
                                       bool force,
                                       const std::function<void()>& before_names) {
  const std::filesystem::path folder = into.empty() ? "." : into;  // the one we are in
  make_folder(folder);
  const FolderLock lock(folder);
  const std::vector<std::string> names = names_of(outputs);
  finish_journal(folder);
  remove_litter(folder);
  std::vector<WholeFile> files;
  for (const OutputFile& output : outputs) {
    for (const std::string& input : inputs) refuse_same_file(input, output.path);
    files.emplace_back(output.path, force).write(output.text);
  }
  std::vector<std::string> stale;
  const bool replaces = force && std::any_of(names.begin(), names.end(), is_document);
  for (const std::string& name : replaces ? earlier_files(folder) : std::set<std::string>{}) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    for (const std::string& input : inputs) refuse_same_file(input, (folder / name).string());
    stale.push_back(name);
  }
  for (WholeFile& file : files) file.prepare();
  if (before_names) before_names();
  give_names(files, stale, folder);
  return stale;
}

Json file_names(const std::vector<OutputFile>& outputs) {
  return Json(names_of(outputs));
}

void refuse_interrupted(const std::filesystem::path& folder) {
  if (!has_journal(folder)) return;
  throw Error(
      {ErrorKind::output,
       "E0516",
       folder.string(),
       "a run was interrupted while it gave its results their names: some files here may be "
       "older than others",
       "",
       "run it again into this folder"});
}

}  // namespace libchar
