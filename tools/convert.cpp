// sensorchar convert LOG -o FILE: between log formats, streaming; what is written reads back to the
// same bits.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/write.hpp"
#include "reading_options.hpp"
#include "verbs.hpp"

namespace sensorchar {
namespace {

struct ConvertOptions {
  std::string log, output;
  libchar::ReadOptions reading;
  libchar::WriteOptions writing;
  std::string endian = "little";
  bool no_time_column = false, json = false;
};

// Writes what it is given; `known` is what an earlier reading found, which is better than what the
// first rows say.
class Writing final : public libchar::BlockSink {
 public:
  Writing(const ConvertOptions& options, const libchar::LogInfo* known)
      : options_(options), known_(known) {}

  void begin(const libchar::LogInfo& so_far) override {
    writer_ = libchar::open_log_writer(
        options_.output, known_ != nullptr ? *known_ : so_far, options_.writing);
  }
  void block(const libchar::SampleBlock& samples) override {
    columns_.clear();
    for (const double* channel : samples.channels) columns_.emplace_back(channel, samples.rows);
    writer_->write(columns_);
  }
  libchar::LogWriter& writer() { return *writer_; }

 private:
  const ConvertOptions& options_;
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

// CSV wants the rate before the first row, and the rate is best known after the last: such a log is
// read twice (or, from a pipe, kept in memory).
libchar::LogInfo transfer(Session& session,
                          const ConvertOptions& options,
                          std::unique_ptr<Writing>& sink) {
  const bool stamps = libchar::format_to_write(options.output, options.writing) == "csv" &&
                      options.writing.time_column;
  if (stamps && libchar::read_once(options.log)) {
    const libchar::Recording recording =
        libchar::read_recording(options.log, options.reading, session.terminal);
    sink = std::make_unique<Writing>(options, nullptr);
    write_whole(*sink, recording);
    return recording.info;
  }
  libchar::LogInfo known;
  if (stamps) {
    libchar::ReadOptions quick = options.reading;
    quick.hash = false;
    Nothing nothing;
    known = libchar::read_log(options.log, quick, nothing, session.terminal);
  }
  sink = std::make_unique<Writing>(options, stamps ? &known : nullptr);
  return libchar::read_log(options.log, options.reading, *sink, session.terminal);
}

void check_paths(const ConvertOptions& options) {
  for (const char* suffix : {"", ".json", ".yaml", ".yml"}) {
    for (const char* other : {"", ".json"})
      libchar::refuse_same_file(options.log + suffix, options.output + other);
  }
}

void run_convert(Session& session, ConvertOptions& options) {
  options.writing.big_endian = options.endian == "big";
  options.writing.time_column = !options.no_time_column;
  check_paths(options);
  std::unique_ptr<Writing> sink;
  const libchar::LogInfo info = transfer(session, options, sink);
  session.terminal.clear();
  report_warnings(session, info);
  // With --strict nothing is written from a log that has warnings.
  if (session.strict && !info.warnings.empty()) return;
  libchar::LogWriter& writer = sink->writer();
  writer.refine(info);
  session.terminal.update(1, "writing " + options.output);  // the last chance to be stopped
  writer.finish();
  const std::vector<std::string> losses = writer.losses();
  for (const std::string& loss : losses)
    session.terminal.note("not kept: " + libchar::printable(loss));
  libchar::Json files = libchar::Json::array();
  std::string text;
  for (const std::string& file : writer.files()) {
    const auto bytes =
        std::filesystem::is_regular_file(file) ? std::filesystem::file_size(file) : 0;
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
  if (!options.json) return print(text);
  libchar::Json document = document_head(session, "convert", {&info});
  document["output"] = files;
  document["rows"] = info.samples;
  document["channels"] = info.channels.size();
  document["not_kept"] = losses;
  print(libchar::dump_json(document));
}

}  // namespace

void add_convert(CLI::App& app, Session& session) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App* verb = add_verb(app,
                            session,
                            "convert",
                            "From one log format to another, without losing a bit",
                            [&session, options] { run_convert(session, *options); });
  verb->add_option("LOG", options->log, "log to read; - reads CSV from standard input")->required();
  verb->add_option("-o,--output",
                   options->output,
                   "file to write; its suffix says the format (.csv, .npy, .f64, .f32, .bin, .raw)")
      ->required()
      ->type_name("FILE");
  add_choice(*verb,
             "--as",
             options->writing.format,
             {"auto", "csv", "npy", "raw"},
             "format to write (default: auto, by the suffix)");
  add_choice(*verb,
             "--dtype",
             options->writing.dtype,
             {"f64", "f32"},
             "npy, raw: type of the numbers (default: f64)");
  add_choice(*verb,
             "--order",
             options->writing.order,
             {"interleaved", "planar"},
             "npy, raw: row by row or channel by channel (default: interleaved)");
  add_choice(*verb,
             "--endian",
             options->endian,
             {"little", "big"},
             "npy, raw: order of the bytes (default: little)");
  verb->add_flag(
      "--no-time-column", options->no_time_column, "csv: leave out the first column t[s] or t[ns]");
  verb->add_flag("--force", options->writing.overwrite, "overwrite an existing file");
  verb->add_flag("--json", options->json, "one JSON document on stdout instead of text");
  add_reading_options(*verb, session, options->reading);
}

}  // namespace sensorchar
