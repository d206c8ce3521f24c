#include "writing_options.hpp"

#include "libchar/core/refusal.hpp"
#include "libchar/log/formats.hpp"

namespace sensorchar {

namespace {

/// Does the log that goes to `output` become a table with a column of stamps? Where its name is not known yet:
/// nothing is refused.
std::optional<bool> becomes_table(const WritingOptions& writing, const std::string& output) {
  if (output.empty()) return std::nullopt;
  if (output == "-" && writing.options.format == "auto") return true;
  return libchar::format_to_write(output, writing.options).writes_stamps;
}

}  // namespace

void add_writing_options(VerbOptions& verb, WritingOptions& writing, const std::string& stamps,
                         const std::string& output) {
  verb.add_choice("--as", writing.options.format, libchar::written_format_words(),
                  "format to write (default: auto, by the suffix)");
  verb.add_choice("--dtype", writing.options.dtype, {"f64", "f32"}, "npy, raw: type of the numbers (default: f64)");
  verb.add_choice("--order", writing.options.order, {"interleaved", "planar"},
                  "npy, raw: row by row or channel by channel (default: interleaved)");
  verb.add_choice("--endian", writing.endian, {"little", "big"}, "npy, raw: order of the bytes (default: little)");
  verb.add_flag("--no-time-column", writing.no_time_column, "csv: leave out the first column " + stamps);
  verb.only("where the log becomes npy or raw",
            [&writing, &output] { return !becomes_table(writing, output).value_or(false); },
            {"--dtype", "--order", "--endian"});
  verb.only("where the log becomes csv", [&writing, &output] { return becomes_table(writing, output).value_or(true); },
            {"--no-time-column"});
}

libchar::WriteOptions write_options(const WritingOptions& writing) {
  libchar::WriteOptions options = writing.options;
  options.big_endian = writing.endian == "big";
  options.time_column = !writing.no_time_column;
  return options;
}

void take_standard_output(std::string& output, WritingOptions& writing, bool json) {
  if (output != "-") return;
  if (json)
    throw libchar::usage_error("E0205", "--json")
        .says("standard output takes one document, and with -o - the log goes there")
        .hint("-o FILE");
  if (writing.options.format == "auto") writing.options.format = "csv";
  output = "/dev/stdout";
}

}  // namespace sensorchar
