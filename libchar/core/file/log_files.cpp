#include "libchar/core/file/log_files.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "libchar/core/document/document.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";
constexpr std::string_view kInformation = "rosbag2_bagfile_information";
constexpr const char* kWriteAgain = "ros2 bag reindex writes it again";

// Only its name counts: old recordings have the folder in front of it, and nothing outside the folder is opened.
std::string part_in(const fs::path& folder, const std::string& said, const std::string& file) {
  const fs::path name = fs::path(said).filename();
  const fs::path part = folder / name;
  std::error_code none;
  if (name.empty() || !fs::is_regular_file(part, none))
    throw input_error("E0448", file)
        .says("names a part of the recording that is not there")
        .got(said)
        .hint("copy it into the folder; of what is there ros2 bag reindex makes a new list");
  return part.string();
}

std::vector<std::string> tables_in(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code none;
  for (fs::directory_iterator at(folder, none), end; !none && at != end; at.increment(none)) {
    const std::string suffix = at->path().extension().string();
    if ((suffix == ".csv" || suffix == ".tsv") && at->is_regular_file(none)) files.push_back(at->path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::string named_log_file(const std::string& path) {
  std::error_code none;
  const fs::path inside = fs::path(path) / kMetadata;
  return fs::is_directory(path, none) && fs::is_regular_file(inside, none) ? inside.string() : path;
}

bool is_rosbag2(const std::string& file) {
  std::error_code none;
  if (fs::path(file).filename() != kMetadata || !fs::is_regular_file(file, none)) return false;
  std::ifstream in(file, std::ios::binary);
  std::string front(4096, '\0');
  in.read(front.data(), static_cast<std::streamsize>(front.size()));
  front.resize(static_cast<std::size_t>(in.gcount()));
  return front.find(kInformation) != std::string::npos;
}

bool detail::is_beneath(const fs::path& file, const fs::path& folder) {
  std::error_code none;
  const fs::path outer = fs::weakly_canonical(folder, none);
  const fs::path inner = fs::weakly_canonical(file, none);
  return !outer.empty() && std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

bool detail::is_of_the_kernel(const fs::path& file) { return is_beneath(file, "/proc") || is_beneath(file, "/sys"); }

bool detail::is_folder_of_tables(const std::string& path) {
  std::error_code none;
  return fs::is_directory(path, none) && named_log_file(path) == path && !tables_in(path).empty();
}

std::vector<std::string> files_of_log(const std::string& file) {
  if (detail::is_folder_of_tables(file)) return tables_in(file);
  std::vector<std::string> files = {file};
  if (!is_rosbag2(file)) return files;
  const Document document = parse_yaml_document(read_document_text(file), file);
  const DocumentEntry* const about = document.find(kInformation);
  const DocumentEntry* const parts = about == nullptr ? nullptr : about->value.find("relative_file_paths");
  if (parts == nullptr || parts->value.kind != Document::Kind::list || parts->value.list.empty())
    throw input_error("E0448", file).says("lists no parts of the recording (relative_file_paths)").hint(kWriteAgain);
  for (const Document& part : parts->value.list)
    files.push_back(part_in(fs::path(file).parent_path(), part.text, file));
  return files;
}

std::string stem_of_log(const std::string& file) {
  const fs::path path = fs::path(named_log_file(file));
  if (path.filename() != kMetadata) return path.stem().string();
  const std::string folder = fs::absolute(path).lexically_normal().parent_path().filename().string();
  return folder.empty() ? path.stem().string() : folder;
}

std::vector<std::string> names_of_logs(const std::vector<std::string>& files) {
  std::vector<std::string> names;
  std::map<std::string, std::size_t> count;
  for (const std::string& file : files) ++count[names.emplace_back(stem_of_log(file))];
  for (std::size_t i = 0; i < files.size(); ++i)
    if (count[names[i]] > 1) names[i] = files[i];
  return names;
}

}  // namespace libchar
