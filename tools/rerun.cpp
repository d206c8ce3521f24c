#include "rerun.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libchar/core/document/result_check.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/report/json/replay_json.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

constexpr const char* kVerbs[] = {"characterize", "replay"};
// What differs from run to run, or says where and how it ran.
std::vector<std::string> ignored_keys() {
  std::vector<std::string> out = {"command", "tool", "files", "files_sha256", "path", "file"};
  out.insert(out.end(), std::begin(kMeasuredKeys), std::end(kMeasuredKeys));
  return out;
}

[[noreturn]] void refuse_rerun(const std::string& document,
                               const std::string& what,
                               const std::string& got) {
  throw Error({ErrorKind::usage,
               "E0205",
               document,
               what,
               got,
               "look at its command, and run that by hand"});
}

/// What the document says, without anything that writes elsewhere than into `folder`: a document is
/// data, its command is no order.
std::vector<std::string> words_of(const std::string& document,
                                  const Json& command,
                                  const std::string& folder) {
  std::vector<std::string> words;
  for (const Json& word : command)
    if (word.is_string()) words.push_back(word.get<std::string>());
  if (words.size() < 2 ||
      std::find(std::begin(kVerbs), std::end(kVerbs), words[1]) == std::end(kVerbs))
    refuse_rerun(document,
                 "only what characterize and replay wrote is run again",
                 words.size() < 2 ? "" : words[1]);
  std::vector<std::string> out = {words[0], words[1]};
  for (std::size_t i = 2; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "-o" || word == "--output") {
      ++i;
      continue;
    }
    if (word.starts_with("--write-scene")) refuse_rerun(document, "it writes a scene too", word);
    const bool dropped = word.starts_with("--output=") || word == "--force" || word == "--json" ||
                         (word.starts_with("-o") && word.size() > 2);
    if (!dropped) out.push_back(word);
  }
  out.insert(out.end(), {"-o", folder});
  return out;
}

/// Nothing that the verb prints is part of what is asked here.
class SilentOutput {
 public:
  SilentOutput() : kept_(::dup(STDOUT_FILENO)) {
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ < 0 || nowhere < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0)
      throw Error({ErrorKind::output, "E0510", "stdout", "cannot be put aside", "", ""});
    ::close(nowhere);
  }
  ~SilentOutput() {
    ::dup2(kept_, STDOUT_FILENO);
    ::close(kept_);
  }
  SilentOutput(const SilentOutput&) = delete;
  SilentOutput& operator=(const SilentOutput&) = delete;

 private:
  int kept_;
};

void run_words(Session& session, const std::vector<std::string>& words) {
  const std::vector<std::string> command = std::exchange(session.command, words);
  const SilentOutput silent;
  CommandLine line("sensorchar", "", "", "");
  for (const VerbEntry& verb : verbs()) line.add(verb, session);
  line.run(words);
  session.terminal.clear();
  session.command = command;
}

bool same_bytes(const fs::path& a, const fs::path& b) {
  constexpr std::size_t kMost = std::size_t{1} << 30U;
  std::error_code ignored;
  return fs::exists(a, ignored) && fs::exists(b, ignored) &&
         file_text(a.string(), kMost) == file_text(b.string(), kMost);
}

/// The page and the Markdown hold the document's numbers and the measured times: the document is compared instead.
bool is_of_numbers(const fs::path& name) {
  return name.extension() != ".json" && name.extension() != ".html" && name.extension() != ".md";
}

}  // namespace

bool Rerun::holds() const {
  const bool digits = std::all_of(differences.begin(), differences.end(), [](const auto& d) {
    return d.relative <= kSameDigits;
  });
  // Tables and models hold the document's numbers: where those are the same, so are their bytes.
  return digits &&
         (!differences.empty() ||
          std::all_of(files.begin(), files.end(), [](const auto& f) { return f.second; }));
}

Rerun rerun(Session& session,
            const std::string& document,
            const std::string& folder,
            const std::string& inputs_in) {
  const Json was = result_document(document);
  const auto words = words_of(document, was.value("command", Json::array()), folder);
  const fs::path into = fs::absolute(folder), from = fs::absolute(document);
  std::vector<std::string> absolute = words;
  absolute.back() = into.string();
  const fs::path here = fs::current_path();
  if (!inputs_in.empty()) fs::current_path(inputs_in);
  run_words(session, absolute);
  fs::current_path(here);
  Rerun out;
  out.document = document;
  out.again = (into / from.filename()).string();
  const Json tool = was.value("tool", Json::object());
  out.same_program = tool.value("version", "") == version() && tool.value("build", "") == build();
  const Json now = result_document(out.again);
  out.differences = json_differences(was, now, ignored_keys());
  for (const Json& name : was.value("files", Json::array())) {
    if (!name.is_string()) continue;
    const fs::path file = fs::path(name.get<std::string>()).filename();
    if (is_of_numbers(file))
      out.files.emplace_back(file.string(), same_bytes(from.parent_path() / file, into / file));
  }
  return out;
}

}  // namespace sensorchar
