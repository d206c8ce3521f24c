#include "rerun.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libchar/core/document/result_check.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/replay/replay_text.hpp"
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

Refusal rerun_refusal(const std::string& document) {
  return usage_error("E0205", document).hint("look at its command, and run that by hand");
}

/// Of a program of its own, so that nothing of this run changes.
std::vector<ParsedWord> parsed_words(const std::vector<std::string>& words) {
  Session session;
  CommandLine line("sensorchar", "", "", "");
  for (const VerbEntry& verb : verbs()) line.add(verb, session);
  return line.parsed(words);
}

std::vector<std::string> words_in(const Json& command) {
  std::vector<std::string> words;
  for (const Json& word : command)
    if (word.is_string()) words.push_back(word.get<std::string>());
  return words;
}

/// What else is opened with a name: sidecars, of a folder all that lies in it. Each may be a link.
std::vector<fs::path> opened_with(const fs::path& file) {
  std::vector<fs::path> out;
  for (const char* suffix : {".json", ".yaml", ".yml"}) out.push_back(fs::path(file) += suffix);
  std::error_code none;
  for (fs::directory_iterator at(file, none), end; !none && at != end; at.increment(none)) out.push_back(at->path());
  return out;
}

/// A document is data: what its command reads lies where one stands (or --in), or beside the folder of the
/// results, unless that is allowed.
void refuse_reading(const RerunOptions& options, const std::vector<ParsedWord>& words) {
  const fs::path here = options.inputs_in.empty() ? "." : options.inputs_in;
  const fs::path beside = fs::absolute(options.document).parent_path().parent_path();
  std::vector<std::string> outside;
  for (const ParsedWord& word : words) {
    if (word.flag == "--allow-outside") outside.push_back(word.flag);
    if (word.writes || word.file.empty() || word.file == "-") continue;
    const auto is_near = [&](const fs::path& file) {
      return detail::is_beneath(file, here) || (beside.has_relative_path() && detail::is_beneath(file, beside));
    };
    const fs::path file = fs::absolute(here) / word.file;
    if (is_near(file)) {
      const std::vector<fs::path> opened = opened_with(file);
      if (std::all_of(opened.begin(), opened.end(), is_near)) continue;
    }
    outside.push_back(printable(word.file));
  }
  if (outside.empty() || options.allow_read) return;
  throw usage_error("E0523", options.document)
      .says("its command reads files outside this folder and the document's: {}", fmt::join(outside, ", "))
      .hint("--allow-read where you trust it");
}

/// The command as its verb understands it, without anything that writes elsewhere than into the folder.
std::vector<std::string> words_of(const RerunOptions& options, const Json& command) {
  const std::vector<std::string> words = words_in(command);
  if (words.size() < 2 || std::find(std::begin(kVerbs), std::end(kVerbs), words[1]) == std::end(kVerbs))
    throw rerun_refusal(options.document)
        .says("only what characterize and replay wrote is run again")
        .got(words.size() < 2 ? "" : words[1]);
  const std::vector<ParsedWord> parsed = parsed_words(words);
  refuse_reading(options, parsed);
  std::vector<std::string> out = {words[0], words[1]}, places;
  for (const ParsedWord& word : parsed) {
    if (word.flag == "--write-scene")
      throw rerun_refusal(options.document).says("it writes a scene too").got(word.value);
    if (word.writes || word.flag == "--json") continue;
    if (word.flag.empty())
      places.push_back(word.value);
    else
      out.push_back(word.flag + (word.value.empty() ? "" : "=" + word.value));
  }
  out.push_back("--output=" + fs::absolute(options.folder).string());
  out.emplace_back("--");
  out.insert(out.end(), places.begin(), places.end());
  return out;
}

/// Nothing that the verb prints is part of what is asked here.
class SilentOutput {
 public:
  SilentOutput() : kept_(::dup(STDOUT_FILENO)) {
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ < 0 || nowhere < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0)
      throw output_error("E0510", "stdout").says("cannot be put aside");
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
  const bool digits =
      std::all_of(differences.begin(), differences.end(), [](const auto& d) { return d.relative <= kSameDigits; });
  // Tables and models hold the document's numbers: where those are the same, so are their bytes.
  return digits &&
         (!differences.empty() || std::all_of(files.begin(), files.end(), [](const auto& f) { return f.second; }));
}

Rerun rerun(Session& session, const RerunOptions& options) {
  const std::string& document = options.document;
  const Json was = result_document(document);
  const auto words = words_of(options, was.value("command", Json::array()));
  const fs::path into = fs::absolute(options.folder), from = fs::absolute(document);
  const fs::path here = fs::current_path();
  if (!options.inputs_in.empty()) fs::current_path(options.inputs_in);
  run_words(session, words);
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
    if (is_of_numbers(file)) out.files.emplace_back(file.string(), same_bytes(from.parent_path() / file, into / file));
  }
  return out;
}

}  // namespace sensorchar
