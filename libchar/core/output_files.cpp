#include "libchar/core/output_files.hpp"

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

void write_outputs(const std::vector<OutputFile>& outputs,
                   const std::filesystem::path& folder,
                   const std::vector<std::string>& inputs,
                   bool force,
                   const std::function<void()>& before_names) {
  make_folder(folder);
  std::vector<WholeFile> files;
  for (const OutputFile& output : outputs) {
    for (const std::string& input : inputs) refuse_same_file(input, output.path);
    files.emplace_back(output.path, force).write(output.text);
  }
  for (WholeFile& file : files) file.prepare();
  if (before_names) before_names();
  for (WholeFile& file : files) file.commit();
}

}  // namespace libchar
