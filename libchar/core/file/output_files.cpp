#include "libchar/core/file/output_files.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "libchar/core/detail/output_journal.hpp"
#include "libchar/core/file/file_owner.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/file/unfinished_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {

namespace {

void make_folder(const std::filesystem::path& folder) {
  if (folder.empty()) return;  // the folder one is in
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) throw output_error("E0505", folder.string()).says("cannot make this folder: " + problem.message());
}

/// Of a document that is replaced; a larger one is none of ours.
constexpr std::size_t kMostReportBytes = std::size_t{1} << 30U;

bool is_document(const std::filesystem::path& path) { return path.extension() == ".json"; }

/// Names that a document gives as files written with it: plain ones. The rest of it is passed over.
std::vector<std::string> files_named_in(const std::string& text) {
  const Json document = detail::parse_loose_json(text, {"files"});
  std::vector<std::string> names;
  if (!document.is_object() || !document.contains("files") || !document["files"].is_array()) return names;
  for (const Json& value : document["files"])
    if (value.is_string() && value.get<std::string>().find('/') == std::string::npos)
      names.push_back(value.get<std::string>());
  return names;
}

}  // namespace

std::vector<std::string> detail::named_files(const std::string& document_file) {
  return files_named_in(file_text(document_file, kMostReportBytes));
}

namespace {

/// Regular files of the folder that this set does not write. Names with a dot in front are of runs: locks and files
/// that are not finished.
std::set<std::string> others_there(const std::vector<OutputFile>& outputs, const std::vector<WholeFile*>& streamed) {
  namespace fs = std::filesystem;
  std::set<std::string> others;
  const fs::path folder = fs::path(outputs.front().path).parent_path();
  std::error_code none;
  for (fs::directory_iterator at(folder.empty() ? "." : folder, none), end; !none && at != end; at.increment(none))
    if (std::error_code ignored; at->symlink_status(ignored).type() == fs::file_type::regular)
      if (std::string name = at->path().filename().string(); !name.starts_with('.')) others.insert(std::move(name));
  for (const OutputFile& output : outputs) others.erase(fs::path(output.path).filename().string());
  for (const WholeFile* file : streamed) others.erase(fs::path(file->path()).filename().string());
  return others;
}

/// Regular files that the documents being replaced list as theirs and the new ones do not; they are removed.
std::vector<std::string> stale_files(const std::vector<OutputFile>& outputs, const std::vector<WholeFile*>& streamed) {
  const auto replaces = [](const OutputFile& output) {
    std::error_code ignored;
    return is_document(output.path) && std::filesystem::is_regular_file(output.path, ignored);
  };
  if (std::none_of(outputs.begin(), outputs.end(), replaces)) return {};
  const std::set<std::string> others = others_there(outputs, streamed);
  if (others.empty()) return {};  // and no document of megabytes is parsed
  std::set<std::string> before, now;
  for (const OutputFile& output : outputs)
    if (replaces(output))
      for (std::string& name : detail::named_files(output.path)) before.insert(std::move(name));
  std::erase_if(before, [&](const std::string& name) { return !others.contains(name); });
  if (before.empty()) return {};
  for (const OutputFile& output : outputs)
    if (is_document(output.path))
      for (std::string& name : files_named_in(output.text)) now.insert(std::move(name));
  std::vector<std::string> stale;
  std::set_difference(before.begin(), before.end(), now.begin(), now.end(), std::back_inserter(stale));
  return stale;
}

/// A file in a folder of results that somebody named: does what is read of it hang on this file?
bool is_of_results(const std::filesystem::path& folder, const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::exists(folder / "metadata.yaml", ignored)) return true;  // a recording of rosbag2
  if (fs::exists(folder / "plan.jsonl", ignored))
    return file.filename() == "plan.jsonl" || file.parent_path() != folder;
  if (is_document(file)) return true;
  for (const auto& entry : fs::directory_iterator(file.parent_path(), ignored)) {
    if (!is_document(entry.path()) || !entry.is_regular_file(ignored) || entry.file_size(ignored) >= kMostReportBytes)
      continue;
    const std::vector<std::string> names = detail::named_files(entry.path().string());
    if (std::find(names.begin(), names.end(), file.filename().string()) != names.end()) return true;
  }
  return false;
}

void refuse_itself(const std::string& input, const std::string& output) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(input, ignored) || !std::filesystem::equivalent(input, output, ignored)) return;
  throw output_error("E0504", output)
      .says("is the input itself; an input is never overwritten")
      .hint("choose another name");
}

void refuse_in_folder(const std::string& input, const std::string& output) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path folder = fs::canonical(input, ignored), file = fs::canonical(output, ignored);
  if (folder.empty() || !fs::is_regular_file(file, ignored)) return;
  const auto apart = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  if (apart.first != folder.end() || !is_of_results(folder, file)) return;
  throw output_error("E0504", output)
      .says("is part of the input; an input is never overwritten")
      .got(input)
      .hint("choose another name");
}

std::filesystem::path folder_of(const WholeFile& file) {
  const auto folder = std::filesystem::path(file.path()).parent_path();
  return folder.empty() ? "." : folder;  // the one we are in
}

/// What a killed run has begun is finished, then what others have left is removed.
void tidy(const std::filesystem::path& folder, const detail::FolderLock& lock) {
  finish_journal(folder);
  if (lock.held()) detail::remove_litter(folder.string());
}

/// All names at once, as far as a file system can: the journal first, then what it says. The folder is locked.
void give_names(const std::vector<WholeFile*>& files, const std::vector<std::string>& stale,
                const std::filesystem::path& folder) {
  for (WholeFile* file : files) file->prepare();
  OutputJournal journal;
  journal.remove = stale;
  for (const WholeFile* file : files)
    if (!file->temporary().empty())
      journal.rename.push_back(waiting_file(folder, std::filesystem::path(file->temporary()).filename().string(),
                                            std::filesystem::path(file->path()).filename().string()));
  for (WholeFile* file : files)
    if (file->temporary().empty()) file->commit();  // a device
  const JournalFile written = journal_file(folder, journal);
  const GivingNames naming;
  // As long as no journal names them all can still be taken back: the temporary files are theirs.
  const auto hand_over = [&] {
    for (WholeFile* file : files) file->hand_over();
  };
  try {
    written.write();
    run_journal(folder, journal);
  } catch (...) {
    if (written.there()) hand_over();
    throw;
  }
  hand_over();
}

/// Files of one folder. Devices and pipes are written through and need no journal: nor may they stand where one can be
/// written.
void commit_set(const std::vector<WholeFile*>& files, const std::filesystem::path& folder) {
  const auto special = [](const WholeFile* file) { return file->special(); };
  if (files.size() == 1 || std::all_of(files.begin(), files.end(), special)) {
    for (WholeFile* file : files) file->commit();
    return;
  }
  const detail::FolderLock lock(folder);
  tidy(folder, lock);
  give_names(files, {}, folder);
}

}  // namespace

void check_outputs(const std::vector<std::string>& paths, const std::filesystem::path& folder,
                   const std::vector<std::string>& inputs, bool force) {
  make_folder(folder);
  for (const std::string& path : paths) {
    for (const std::string& input : inputs) refuse_same_file(input, path);
    check_output(path, force);
  }
}

void foresee_outputs(const std::vector<std::string>& paths, const std::filesystem::path& folder,
                     const std::vector<std::string>& inputs, bool force) {
  std::error_code ignored;
  const auto there = std::filesystem::status(folder.empty() ? "." : folder, ignored).type();
  if (there != std::filesystem::file_type::not_found) check_outputs(paths, folder, inputs, force);
}

std::vector<std::string> write_outputs(const std::vector<OutputFile>& outputs, const std::filesystem::path& into,
                                       const std::vector<std::string>& inputs, bool force,
                                       const std::vector<WholeFile*>& streamed) {
  const std::filesystem::path folder = into.empty() ? "." : into;  // the one we are in
  make_folder(folder);
  std::vector<WholeFile> files;
  for (const OutputFile& output : outputs) {
    for (const std::string& input : inputs) refuse_same_file(input, output.path);
    files.emplace_back(output.path, force).write(output.text);
  }
  for (WholeFile& file : files) file.flush_to_disk();
  for (WholeFile* file : streamed) file->flush_to_disk();
  const detail::FolderLock lock(folder);
  tidy(folder, lock);
  const auto stale = force ? stale_files(outputs, streamed) : std::vector<std::string>{};
  for (const std::string& name : stale)
    for (const std::string& input : inputs) refuse_same_file(input, (folder / name).string());
  std::vector<WholeFile*> all;
  all.reserve(files.size() + streamed.size());
  for (WholeFile& file : files) all.push_back(&file);
  all.insert(all.end(), streamed.begin(), streamed.end());
  give_names(all, stale, folder);
  return stale;
}

void commit_together(const std::vector<WholeFile*>& files) {
  if (files.size() == 1) return files.front()->commit();
  for (WholeFile* file : files) {
    file->flush_to_disk();
    file->refuse_taken();
  }
  std::vector<std::filesystem::path> folders;
  for (const WholeFile* file : files)
    if (std::find(folders.begin(), folders.end(), folder_of(*file)) == folders.end())
      folders.push_back(folder_of(*file));
  for (const auto& folder : folders) {
    std::vector<WholeFile*> set;
    for (WholeFile* file : files)
      if (folder_of(*file) == folder) set.push_back(file);
    commit_set(set, folder);
  }
}

void refuse_same_file(const std::string& input, const std::string& output) {
  std::error_code ignored;
  if (std::filesystem::is_directory(input, ignored)) return refuse_in_folder(input, output);
  refuse_itself(input, output);
  if (std::filesystem::path(input).extension() != ".csv")
    for (const char* sidecar : {".json", ".yaml", ".yml"}) refuse_itself(input + sidecar, output);
  if (is_rosbag2(input))
    for (const std::string& part : files_of_log(input)) refuse_itself(part, output);
}

WrittenFile detail::as_written(const OutputFile& file) {
  Sha256 hash;
  hash.update(file.text);
  return {file.path, hash.finish()};
}

void name_files(Json& document, const std::vector<OutputFile>& outputs) {
  std::vector<WrittenFile> files;
  for (const OutputFile& output : outputs) files.push_back(detail::as_written(output));
  name_files(document, files);
}

void name_files(Json& document, const std::vector<WrittenFile>& outputs) {
  document["files"] = Json::array();
  document["files_sha256"] = Json::object();
  for (const WrittenFile& output : outputs) {
    const std::string name = std::filesystem::path(output.path).filename().string();
    document["files"].push_back(name);
    if (!is_document(output.path)) document["files_sha256"][name] = output.sha256;
  }
}

void refuse_interrupted(const std::filesystem::path& folder_or_file) {
  std::error_code ignored;
  const bool whole = std::filesystem::is_directory(folder_or_file, ignored);
  auto folder = whole ? folder_or_file : folder_or_file.parent_path();
  if (folder.empty()) folder = ".";
  if (whole ? !has_journal(folder) : !journal_names(folder, folder_or_file.filename())) return;
  throw output_error("E0516", folder.string())
      .says("a run was interrupted while it gave its results their names: some files here may be older than others")
      .hint("run it again into this folder");
}

namespace {

constexpr std::size_t kLongest = 100;  // bytes; file systems take 255, and suffixes follow

bool plain_ascii(std::uint32_t c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

// What beyond ASCII is no letter, digit or sign with a shape of its own: controls, blanks, invisible and private
// characters.
bool unusual(std::uint32_t c) {
  return c <= 0xA0 || c == 0xAD || c == 0x061C || c == 0x1680 || c == 0x180E || (c >= 0x2000 && c <= 0x206F) ||
         c == 0x3000 || (c >= 0xE000 && c <= 0xF8FF) || c == 0xFEFF || (c >= 0xFFF0 && c <= 0xFFFF) || c >= 0xE0000;
}

// Small letters for capitals of the scripts that have them in pairs: Latin, Greek, Cyrillic.
std::uint32_t small(std::uint32_t c) {
  if ((c >= 'A' && c <= 'Z') || (c >= 0xC0 && c <= 0xDE && c != 0xD7) || (c >= 0x391 && c <= 0x3A9) ||
      (c >= 0x410 && c <= 0x42F))
    return c + 0x20;
  if (c >= 0x400 && c <= 0x40F) return c + 0x50;
  const bool even_capitals = (c >= 0x100 && c <= 0x137) || (c >= 0x14A && c <= 0x177);
  const bool odd_capitals = (c >= 0x139 && c <= 0x148) || (c >= 0x179 && c <= 0x17E);
  return (even_capitals && c % 2 == 0) || (odd_capitals && c % 2 == 1) ? c + 1 : c;
}

std::string folded(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size();) {
    std::uint32_t code = 0;
    const std::size_t length = decode_utf8(name, i, code);
    if (length > 0 && code < 0x800)
      append_utf8(out, small(code));
    else
      out.append(name.substr(i, length > 0 ? length : 1));
    i += length > 0 ? length : 1;
  }
  return out;
}

// At most `bytes` of a text, whole characters only.
std::string_view cut(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0U) == 0x80U) --bytes;
  return text.substr(0, bytes);
}

}  // namespace

std::string file_name_for(std::string_view channel) {
  std::string name;
  for (std::size_t i = 0; i < channel.size() && name.size() <= kLongest;) {
    std::uint32_t code = 0;
    const std::size_t length = decode_utf8(channel, i, code);
    if (length > 0 && (code < 0x80 ? plain_ascii(code) : !unusual(code)))
      name.append(channel.substr(i, length));
    else
      name += '_';
    i += length > 0 ? length : 1;
  }
  if (name.empty() || name[0] == '.') name.insert(0, "_");
  return std::string(cut(name, kLongest));
}

std::string unused_file_name_for(std::string_view channel, std::set<std::string>& taken) {
  const std::string stem = file_name_for(channel);
  std::string name = stem;
  for (int again = 2; !taken.insert(folded(name)).second; ++again) {
    const std::string suffix = "_" + std::to_string(again);
    name = std::string(cut(stem, kLongest - suffix.size())) + suffix;
  }
  return name;
}

}  // namespace libchar
