#include "writing_options.hpp"

#include "libchar/core/error.hpp"
#include "libchar/log/formats.hpp"

namespace sensorchar {

void add_writing_options(VerbOptions& verb, WritingOptions& writing, const std::string& stamps) {
  verb.add_choice("--as",
                  writing.options.format,
                  libchar::written_format_words(),
                  "format to write (default: auto, by the suffix)");
  verb.add_choice("--dtype",
                  writing.options.dtype,
                  {"f64", "f32"},
                  "npy, raw: type of the numbers (default: f64)");
  verb.add_choice("--order",
                  writing.options.order,
                  {"interleaved", "planar"},
                  "npy, raw: row by row or channel by channel (default: interleaved)");
  verb.add_choice("--endian",
                  writing.endian,
                  {"little", "big"},
                  "npy, raw: order of the bytes (default: little)");
  verb.add_flag(
      "--no-time-column", writing.no_time_column, "csv: leave out the first column " + stamps);
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
    throw libchar::Error({libchar::ErrorKind::usage,
                          "E0205",
                          "--json",
                          "standard output takes one document, and with -o - the log goes there",
                          "",
                          "-o FILE"});
  if (writing.options.format == "auto") writing.options.format = "csv";
  output = "/dev/stdout";
}

}  // namespace sensorchar
