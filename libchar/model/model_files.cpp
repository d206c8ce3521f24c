#include "libchar/model/model_files.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "libchar/core/error.hpp"
#include "libchar/core/file/output_files.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".sensor.yaml";

/// Those that a report names as its own.
std::vector<std::string> named_by(const fs::path& report) {
  refuse_interrupted(report);
  std::vector<std::string> files;
  for (const std::string& name : detail::named_files(report.string()))
    if (name.ends_with(kEnding)) files.push_back((report.parent_path() / name).string());
  return files;
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    entries.push_back(entry.path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<std::string> models_in(const fs::path& folder) {
  std::error_code ignored;
  if (const fs::path report = folder / "report.json"; fs::is_regular_file(report, ignored))
    return named_by(report);
  std::vector<std::string> files;
  for (const fs::path& entry : entries_of(folder))
    if (entry.string().ends_with(kEnding)) files.push_back(entry.string());
  return files;
}

}  // namespace

std::vector<std::string> model_files(const std::string& path) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(path, ignored);
  if (!is_folder && fs::path(path).filename() != "report.json") return {path};
  std::vector<std::string> files = is_folder ? models_in(path) : named_by(path);
  if (is_folder && files.empty())
    for (const fs::path& entry : entries_of(path))
      if (fs::is_directory(entry, ignored))
        for (std::string& file : models_in(entry)) files.push_back(std::move(file));
  if (files.empty())
    throw Error(
        {ErrorKind::input,
         "E0551",
         path,
         is_folder ? "the folder holds no sensor model" : "the report names no sensor model",
         "",
         "sensorchar characterize writes one for each channel that it can fit"});
  return files;
}

}  // namespace libchar
