#include "libchar/core/document/result_check.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostOfDocument = std::size_t{1} << 30U;
constexpr std::size_t kPieceOfFile = std::size_t{1} << 20U;

/// SHA-256 of a file of any length, with the parts behind it where it is a list of them; "" where it cannot be read.
std::string digest_of(const std::string& path) {
  try {
    Sha256 hash;
    for (const std::string& file : files_of_log(path))
      for_pieces_of_file(file, kPieceOfFile, [&](std::string_view piece) { hash.update(piece); });
    return hash.finish();
  } catch (const Error&) {
    return "";
  }
}

/// Files against digests; each is read once, under however many names a document has it.
class FileStates {
 public:
  FileState of(const std::string& path, const std::string& digest) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored) || detail::is_of_the_kernel(path)) return FileState::missing;
    if (digest.empty()) return FileState::there;
    const auto [known, fresh] = digests_.try_emplace(fs::canonical(path, ignored).string());
    if (fresh) known->second = digest_of(path);
    const std::string& now = known->second;
    return now.empty() ? FileState::missing : now == digest ? FileState::same : FileState::changed;
  }

 private:
  std::map<std::string, std::string> digests_;
};

std::string text_at(const Json& object, const char* key) {
  const auto it = object.is_object() ? object.find(key) : object.end();
  return it != object.end() && it->is_string() ? it->get<std::string>() : "";
}

const Json& member(const Json& object, const char* key) {
  static const Json kNothing;
  return object.is_object() && object.contains(key) ? object[key] : kNothing;
}

const Json& list_at(const Json& object, const char* key) {
  static const Json kEmpty = Json::array();
  const Json& value = member(object, key);
  return value.is_array() ? value : kEmpty;
}

CheckedFile checked_input(const Json& input, const std::string& inputs_in, FileStates& states) {
  CheckedFile out{text_at(input, "path"), true, FileState::unknown};
  if (out.path == "standard input") return out;
  if (!inputs_in.empty()) out.path = (fs::path(inputs_in) / out.path).string();
  out.state = states.of(out.path, text_at(input, "sha256"));
  return out;
}

ResultCheck check_document(const fs::path& path, const Json& document, const std::string& inputs_in) {
  const Json& tool = member(document, "tool");
  ResultCheck out{path.string(), text_at(tool, "version"), text_at(tool, "build"), {}};
  FileStates states;
  for (const Json& input : list_at(document, "input")) out.files.push_back(checked_input(input, inputs_in, states));
  std::map<std::string, std::string> digests;
  if (const Json& said = member(document, "files_sha256"); said.is_object())
    for (const auto& [name, digest] : said.items())
      if (digest.is_string()) digests.emplace(name, digest.get<std::string>());
  for (const Json& name : list_at(document, "files")) {
    if (!name.is_string()) continue;
    const fs::path file = path.parent_path() / fs::path(name.get<std::string>()).filename();
    const auto digest = digests.find(name.get<std::string>());
    out.files.push_back(
        {file.string(), false, states.of(file.string(), digest == digests.end() ? "" : digest->second)});
  }
  return out;
}

/// What a document says of its files. The rest of it, which may be anything, is passed over.
Json named_parts(const std::string& path) {
  return detail::parse_loose_json(file_text(path, kMostOfDocument), {"tool", "input", "files", "files_sha256"});
}

}  // namespace

Json result_document(const std::string& path) { return detail::parse_loose_json(file_text(path, kMostOfDocument)); }

std::string_view state_word(FileState state) {
  switch (state) {
    case FileState::same:
      return "same";
    case FileState::changed:
      return "changed";
    case FileState::missing:
      return "missing";
    case FileState::there:
      return "there";
    case FileState::unknown:
      return "not known";
  }
  return "";
}

bool ResultCheck::holds() const {
  return std::none_of(files.begin(), files.end(), [](const CheckedFile& file) {
    return file.state == FileState::changed || file.state == FileState::missing;
  });
}

std::vector<std::string> detail::result_documents(const std::string& folder_or_document) {
  refuse_interrupted(folder_or_document);
  std::vector<fs::path> documents = {folder_or_document};
  std::error_code problem;
  const bool folder = fs::is_directory(folder_or_document, problem);
  if (folder) {
    documents.clear();
    for (fs::directory_iterator entry(folder_or_document, problem), end; !problem && entry != end;
         entry.increment(problem))
      if (entry->path().extension() == ".json") documents.push_back(entry->path());
    std::sort(documents.begin(), documents.end());
  }
  std::vector<std::string> out;
  for (const fs::path& path : documents) {
    const Json document = named_parts(path.string());
    if (document.is_object() && document.contains("files") && document.contains("tool")) out.push_back(path.string());
  }
  if (out.empty())
    throw input_error("E0556", folder_or_document)
        .says(folder ? "holds no document that names its files (report.json, runs.json, lot.json)"
                     : "is not a document that names its files (report.json, runs.json, lot.json)")
        .hint("name a folder that characterize or replay has written");
  return out;
}

std::vector<ResultCheck> check_results(const std::string& folder_or_document, const std::string& inputs_in) {
  std::vector<ResultCheck> out;
  for (const std::string& path : detail::result_documents(folder_or_document))
    out.push_back(check_document(path, named_parts(path), inputs_in));
  return out;
}

}  // namespace libchar
