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

/// Names that a document gives as files written with it: plain ones.
std::set<std::string> files_named_in(const Json& document) {
  std::set<std::string> names;
  if (!document.is_object() || !document.contains("files") || !document["files"].is_array())
    return names;
  for (const Json& value : document["files"])
    if (value.is_string() && value.get<std::string>().find('/') == std::string::npos)
      names.insert(value.get<std::string>());
  return names;
}

/// What the documents that this set replaces name as theirs and its own do not: regular files of the folder.
std::vector<std::string> stale_files(const std::vector<OutputFile>& outputs) {
  namespace fs = std::filesystem;
  std::set<std::string> before, now;
  for (const OutputFile& output : outputs) {
    now.insert(fs::path(output.path).filename().string());
    if (!is_document(output.path)) continue;
    std::ifstream file(output.path, std::ios::binary);
    before.merge(files_named_in(Json::parse(file, nullptr, false)));
    now.merge(files_named_in(Json::parse(output.text, nullptr, false)));
  }
  std::vector<std::string> stale;
  for (const std::string& name : before) {
    std::error_code ignored;
    const fs::path path = fs::path(outputs.front().path).replace_filename(name);
    if (!now.contains(name) && fs::symlink_status(path, ignored).type() == fs::file_type::regular)
      stale.push_back(name);
  }
  return stale;
}

/// Temporary files (WholeFile) that a process which is no more has left.
void remove_litter(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t mark = name.rfind(kTemporaryMark);
    if (mark == std::string::npos || !entry.is_regular_file(ignored)) continue;
    const std::string number = name.substr(mark + kTemporaryMark.size());
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
    check_output(path, force);
  }
}

void foresee_outputs(const std::vector<std::string>& paths,
                     const std::filesystem::path& folder,
                     const std::vector<std::string>& inputs,
                     bool force) {
  std::error_code ignored;
  const auto there = std::filesystem::status(folder.empty() ? "." : folder, ignored).type();
  if (there != std::filesystem::file_type::not_found) check_outputs(paths, folder, inputs, force);
}

std::vector<std::string> write_outputs(const std::vector<OutputFile>& outputs,
                                       const std::filesystem::path& into,
                                       const std::vector<std::string>& inputs,
                                       bool force,
                                       const std::function<void()>& before_names) {
  const std::filesystem::path folder = into.empty() ? "." : into;  // the one we are in
  make_folder(folder);
  const FolderLock lock(folder);
  finish_journal(folder);
  remove_litter(folder);
  std::vector<WholeFile> files;
  for (const OutputFile& output : outputs) {
    for (const std::string& input : inputs) refuse_same_file(input, output.path);
    files.emplace_back(output.path, force).write(output.text);
  }
  const auto stale = force ? stale_files(outputs) : std::vector<std::string>{};
  for (const std::string& name : stale)
    for (const std::string& input : inputs) refuse_same_file(input, (folder / name).string());
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
