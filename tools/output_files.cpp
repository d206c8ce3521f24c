#include "output_files.hpp"

#include "libchar/core/error.hpp"
#include "libchar/core/whole_file.hpp"

namespace sensorchar {

using namespace libchar;

void write_outputs(const std::vector<OutputFile>& outputs,
                   const std::filesystem::path& folder,
                   const std::vector<std::string>& inputs,
                   bool force,
                   const std::function<void()>& before_names) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem)
    throw Error({ErrorKind::output,
                 "E0505",
                 folder.string(),
                 "cannot make this folder: " + problem.message(),
                 "",
                 ""});
  std::vector<WholeFile> files;
  for (const OutputFile& output : outputs) {
    for (const std::string& input : inputs) refuse_same_file(input, output.path);
    files.emplace_back(output.path, force).write(output.text);
  }
  for (WholeFile& file : files) file.prepare();
  if (before_names) before_names();
  for (WholeFile& file : files) file.commit();
}

}  // namespace sensorchar
