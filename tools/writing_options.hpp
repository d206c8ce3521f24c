#pragma once
#include <string>

#include "command_line.hpp"
#include "libchar/log/write.hpp"

namespace sensorchar {

/// What the flags of writing a log say; `write_options` makes options of it.
struct WritingOptions {
  libchar::WriteOptions options;
  std::string endian = "little";
  bool no_time_column = false;
};

/// Adds every flag that says how a log is to be written (--as, --dtype, --order, --endian,
/// --no-time-column). `stamps` is what the time column is called ("t[s]"). `writing` must live until
/// the verb has run.
void add_writing_options(VerbOptions& verb, WritingOptions& writing, const std::string& stamps,
                         const std::string& output);

libchar::WriteOptions write_options(const WritingOptions& writing);

/// `output` is "-": the log goes to standard output, as CSV unless another format is asked for.
/// Throws where `json` is to go there too.
void take_standard_output(std::string& output, WritingOptions& writing, bool json);

}  // namespace sensorchar
