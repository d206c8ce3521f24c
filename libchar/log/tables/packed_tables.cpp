// The recordings of phones: a .zip or a folder of CSV files, one for each sensor (Sensor Logger, phyphox, Physics
// Toolbox). Each file is a topic.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "libchar/core/file/log_files.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/json_rows.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/tables/member_text.hpp"
#include "libchar/log/tables/table_reader.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

class MemberUnpacker final : public csv::Unpacker {
 public:
  MemberUnpacker(const BinaryFile& file, const ZipMember& member) : text_(file, member) {}
  std::size_t read(char* to, std::size_t n) override { return text_.read(to, n); }
  bool cut() const override { return false; }
  std::string_view what() const override { return "from an archive"; }

 private:
  MemberText text_;
};

bool is_table_name(const std::string& name) {
  const std::string file = fs::path(name).filename().string(),
                    suffix = ascii_lower(fs::path(name).extension().string());
  // phyphox describes the phone in meta, macOS keeps attributes beside the files.
  return (suffix == ".csv" || suffix == ".tsv" || suffix == ".txt") && !file.starts_with("._") &&
         !name.starts_with("__MACOSX/") && name.find("meta/") == std::string::npos;
}

/// Without the suffix, and without the folder that all are in.
std::vector<std::string> table_names(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  std::string folder = paths.empty() ? "" : fs::path(paths[0]).parent_path().string();
  for (const std::string& path : paths)
    if (fs::path(path).parent_path() != folder) folder.clear();
  for (const std::string& path : paths) {
    const std::string inside = folder.empty() ? path : path.substr(folder.size() + 1);
    names.push_back(inside.substr(0, inside.rfind('.')));
  }
  return names;
}

class ZipTables final : public TableReader {
 public:
  ZipTables(const std::string& path, const ReadOptions&) : file_(path) {
    std::vector<std::string> names;
    for (ZipMember& member : read_zip_directory(file_))
      if (is_table_name(member.name)) {
        names.push_back(member.name);
        members_.push_back(std::move(member));
      }
    for (const std::string& name : table_names(names)) list_table(name);
  }
  std::vector<std::string> dialect() const override { return {"ZIP archive of " + plural(members_.size(), "table")}; }
  std::unique_ptr<RowSource> open_table(std::size_t topic, const ReadOptions& options) override {
    return csv::open_text(std::make_unique<MemberUnpacker>(file_, members_[topic]),
                          file_.path() + "/" + members_[topic].name, options);
  }

 private:
  BinaryFile file_;
  std::vector<ZipMember> members_;
};

class FolderTables final : public TableReader {
 public:
  FolderTables(const std::string& path, const ReadOptions&) : files_(files_of_log(path)) {
    for (const std::string& name : table_names(files_)) list_table(name);
  }
  std::vector<std::string> dialect() const override { return {"folder of " + plural(files_.size(), "table")}; }
  std::unique_ptr<RowSource> open_table(std::size_t topic, const ReadOptions& options) override {
    return find_format("csv")->open(files_[topic], options);
  }

 private:
  std::vector<std::string> files_;
};

bool holds_table(std::string_view front) {
  if (!front.starts_with(kLocalMagic) || front.size() < 30) return false;
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(front[i])); };
  return is_table_name(std::string(front.substr(30, byte(26) + 256 * byte(27))));
}

}  // namespace

Format tables_format() {
  Format row;
  row.about.name = "tables";
  row.about.title = "CSV files of a phone";
  row.about.suffixes = {".zip"};
  row.about.otherwise = "a folder of CSV files";
  row.about.topics = row.about.text = true;
  row.sniff = [](const std::string& path, std::string_view front) {
    return detail::is_folder_of_tables(path) || holds_table(front);
  };
  row.topics = [](const std::string& path, const ReadOptions& options) -> std::unique_ptr<TopicReader> {
    if (detail::is_folder_of_tables(path)) return std::make_unique<FolderTables>(path, options);
    return std::make_unique<ZipTables>(path, options);
  };
  return row;
}

}  // namespace libchar
