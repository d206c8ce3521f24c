// sensorchar convert LOG -o FILE: between log formats.

#include "libchar/log/convert.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/formats.hpp"
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

/// Asked for, or else found at its end: never the number that stands for a refusal.
std::uint64_t bytes_of(const std::string& file) {
  std::error_code refused;
  if (const auto bytes = std::filesystem::file_size(file, refused); !refused) return bytes;
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  return stream ? static_cast<std::uint64_t>(std::streamoff{stream.tellg()}) : 0;
}

void run_convert(Session& session, const ConvertVerb& given) {
  ConvertVerb verb = given;
  take_standard_output(verb.output, verb.writing, verb.json);
  const libchar::Conversion result = libchar::convert_log(
      verb.log, verb.output, {verb.reading, write_options(verb.writing), session.strict}, session.terminal);
  const libchar::LogInfo& info = result.log;
  session.terminal.clear();
  report_warnings(session, info);
  if (result.files.empty()) return;  // --strict
  for (const std::string& loss : result.losses) session.terminal.note("not kept: " + libchar::printable(loss));
  libchar::Json files = libchar::Json::array();
  std::string text;
  for (const std::string& file : result.files) {
    const bool passed_on = libchar::writes_through(file);
    const auto bytes = passed_on ? 0 : bytes_of(file);
    files.push_back({{"path", libchar::printable(file)}, {"bytes", bytes}});
    const std::string size = passed_on ? "" : fmt::format(", {} bytes", bytes);
    text += text.empty() ? fmt::format("{}: {} rows, {}{}\n", libchar::printable(file), info.samples,
                                       libchar::plural(info.channels.size(), "channel"), size)
                         : fmt::format("{}: its sidecar{}\n", libchar::printable(file), size);
  }
  if (!verb.json) return print_summary(session, verb.output, text);
  libchar::Json document = document_head(session, "convert", {&info});
  document["output"] = files;
  document["rows"] = info.samples;
  document["channels"] = info.channels.size();
  document["not_kept"] = result.losses;
  print(libchar::dump_json(document));
}

std::function<void()> convert_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<ConvertVerb>();
  options.add_text("LOG", verb->log, "log to read; - reads CSV from standard input").required();
  options
      .add_text("-o,--output", verb->output,
                "file to write; its suffix says the format (" + libchar::written_suffixes() + "; - is standard output)")
      .required()
      .value_name("FILE");
  add_writing_options(options, verb->writing, "t[s] or t[ns]", verb->output);
  options.add_flag("--force", verb->writing.options.overwrite, "overwrite an existing file");
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  add_reading_options(options, session, verb->reading);
  return [&session, verb] { run_convert(session, *verb); };
}

}  // namespace

VerbEntry verb_convert() {
  return {10,
          "convert",
          "Convert a log to another format, bit by bit",
          convert_options,
          {{"a table as NumPy file, bit by bit", "sensorchar convert imu.csv -o imu.npy"},
           {"one channel of the first minute", "sensorchar convert imu.csv -c gyro_z --to 1min -o minute.csv"}}};
}

}  // namespace sensorchar
