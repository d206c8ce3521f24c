// sensorchar convert LOG -o FILE: between log formats, streaming; what is written reads back to the
// same bits.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/write.hpp"
#include "reading_options.hpp"
#include "verb.hpp"
#include "writing_options.hpp"

namespace sensorchar {
namespace {

struct ConvertVerb {
  std::string log, output;
  libchar::ReadOptions reading;
  WritingOptions writing;
  bool json = false;
};

// Writes what it is given; `known` is what an earlier reading found, which is better than what the
// first rows say.
class Writing final : public libchar::BlockSink {
 public:
  Writing(const ConvertVerb& verb, const libchar::LogInfo* known) : verb_(verb), known_(known) {}

  void begin(const libchar::LogInfo& so_far) override {
    writer_ = libchar::open_log_writer(
        verb_.output, known_ != nullptr ? *known_ : so_far, write_options(verb_.writing));
  }
  void block(const libchar::SampleBlock& samples) override {
    columns_.clear();
    for (const double* channel : samples.channels) columns_.emplace_back(channel, samples.rows);
    writer_->write(columns_);
  }
  libchar::LogWriter& writer() { return *writer_; }

 private:
  const ConvertVerb& verb_;
  const libchar::LogInfo* known_;
  std::unique_ptr<libchar::LogWriter> writer_;
  std::vector<std::span<const double>> columns_;
};

struct Nothing final : libchar::BlockSink {
  void begin(const libchar::LogInfo&) override {}
  void block(const libchar::SampleBlock&) override {}
};

void write_whole(Writing& sink, const libchar::Recording& recording) {
  sink.begin(recording.info);
  libchar::SampleBlock all;
  all.rows = static_cast<std::size_t>(recording.info.samples);
  for (const auto& channel : recording.samples) all.channels.push_back(channel.data());
  sink.block(all);
}

// Stamps want the rate before the first row, and the rate is best known after the last: such a log
// is read twice (or, from a pipe, kept in memory).
libchar::LogInfo transfer(Session& session,
                          const ConvertVerb& verb,
                          std::unique_ptr<Writing>& sink) {
  const bool stamps = libchar::writes_stamps(verb.output, write_options(verb.writing));
  if (stamps && libchar::read_once(verb.log)) {
    const libchar::Recording recording =
        libchar::read_recording(verb.log, verb.reading, session.terminal);
    sink = std::make_unique<Writing>(verb, nullptr);
    write_whole(*sink, recording);
    return recording.info;
  }
  libchar::LogInfo known;
  if (stamps) {
    libchar::ReadOptions quick = verb.reading;
    quick.hash = false;
    Nothing nothing;
    known = libchar::read_log(verb.log, quick, nothing, session.terminal);
  }
  sink = std::make_unique<Writing>(verb, stamps ? &known : nullptr);
  return libchar::read_log(verb.log, verb.reading, *sink, session.terminal);
}

void check_paths(const ConvertVerb& verb) {
  for (const char* suffix : {"", ".json", ".yaml", ".yml"}) {
    for (const char* other : {"", ".json"})
      libchar::refuse_same_file(verb.log + suffix, verb.output + other);
  }
  libchar::check_log_output(verb.output, write_options(verb.writing));
}

void run_convert(Session& session, const ConvertVerb& verb) {
  check_paths(verb);
  std::unique_ptr<Writing> sink;
  const libchar::LogInfo info = transfer(session, verb, sink);
  session.terminal.clear();
  report_warnings(session, info);
  // With --strict nothing is written from a log that has warnings.
  if (session.strict && !info.warnings.empty()) return;
  libchar::LogWriter& writer = sink->writer();
  writer.refine(info);
  session.terminal.update(1, "writing " + verb.output);  // the last chance to be stopped
  writer.finish();
  const std::vector<std::string> losses = writer.losses();
  for (const std::string& loss : losses)
    session.terminal.note("not kept: " + libchar::printable(loss));
  libchar::Json files = libchar::Json::array();
  std::string text;
  for (const std::string& file : writer.files()) {
    std::error_code ignored;
    const auto bytes =
        libchar::writes_through(file) ? 0 : std::filesystem::file_size(file, ignored);
    files.push_back({{"path", libchar::printable(file)}, {"bytes", bytes}});
    text += text.empty()
                ? fmt::format("{}: {} rows, {} channel{}, {} bytes\n",
                              libchar::printable(file),
                              info.samples,
                              info.channels.size(),
                              info.channels.size() == 1 ? "" : "s",
                              bytes)
                : fmt::format("{}: its sidecar, {} bytes\n", libchar::printable(file), bytes);
  }
  if (!verb.json) return print_summary(session, verb.output, text);
  libchar::Json document = document_head(session, "convert", {&info});
  document["output"] = files;
  document["rows"] = info.samples;
  document["channels"] = info.channels.size();
  document["not_kept"] = losses;
  print(libchar::dump_json(document));
}

std::function<void()> convert_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<ConvertVerb>();
  options.add_text("LOG", verb->log, "log to read; - reads CSV from standard input").required();
  options
      .add_text("-o,--output",
                verb->output,
                "file to write; its suffix says the format (" + libchar::written_suffixes() + ")")
      .required()
      .value_name("FILE");
  add_writing_options(options, verb->writing, "t[s] or t[ns]");
  options.add_flag("--force", verb->writing.options.overwrite, "overwrite an existing file");
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  add_reading_options(options, session, verb->reading);
  return [&session, verb] { run_convert(session, *verb); };
}

}  // namespace

VerbEntry verb_convert() {
  return {10, "convert", "From one log format to another, without losing a bit", convert_options};
}

}  // namespace sensorchar
