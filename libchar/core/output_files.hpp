#pragma once
// The files of one job: all of them or none.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace libchar {

struct OutputFile {
  std::string path, text;
};

/// Makes the folder and finds out whether these files can be written, before hours of work. Throws
/// as `write_outputs`.
void check_outputs(const std::vector<std::string>& paths,
                   const std::filesystem::path& folder,
                   const std::vector<std::string>& inputs,
                   bool force);

/// Makes the folder and writes all files before the first gets its name: a full disk leaves none of
/// them. Throws Error(output) when one exists and `force` is false, or is one of `inputs`.
/// `before_names` runs when everything is on disk.
void write_outputs(const std::vector<OutputFile>& outputs,
                   const std::filesystem::path& folder,
                   const std::vector<std::string>& inputs,
                   bool force,
                   const std::function<void()>& before_names = {});

}  // namespace libchar
