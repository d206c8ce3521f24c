#include "libchar/log/write.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

void check_word(const char* option, const std::string& got, const std::vector<std::string>& words) {
  if (std::find(words.begin(), words.end(), got) == words.end())
    throw usage_error("E0507", option).says("expected {}", fmt::join(words, " or ")).got(got);
}

// "a, b or c".
std::string listed(const std::vector<std::string>& words, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) text += (i == 0 ? "" : i + 1 == words.size() ? last : ", ") + words[i];
  return text;
}

const Format& format_to_write_of(const std::string& path, const WriteOptions& options) {
  if (options.format == "auto") {
    if (const Format* format = written_format_by_suffix(path)) return *format;
    throw usage_error("E0506", path)
        .says("the suffix does not say which format to write")
        .hint("end the name in one of {}, or name the format", written_suffixes());
  }
  const Format* const format = find_format(options.format);
  if (format && format->write) return *format;
  std::vector<std::string> words = written_format_words();
  words.erase(words.begin());
  throw usage_error("E0506", path)
      .says("no such format to write; " + listed(words, " and ") + " are written")
      .got(options.format);
}

}  // namespace

LogFormat format_to_write(const std::string& path, const WriteOptions& options) {
  return format_to_write_of(path, options).about;
}

bool writes_stamps(const std::string& path, const WriteOptions& options) {
  return format_to_write(path, options).writes_stamps && options.time_column;
}

void check_log_output(const std::string& path, const WriteOptions& options) {
  LogInfo any;
  any.channels = {{"x", "", false}};
  // A pipe is not opened: who reads it would take that for the whole of it.
  if (writes_through(path))
    format_to_write_of(path, options);
  else
    open_log_writer(path, any, options);  // discarded: nothing appears under its names
}

std::unique_ptr<LogWriter> open_log_writer(const std::string& path, const LogInfo& info, const WriteOptions& options) {
  check_word("`dtype`", options.dtype, {"f64", "f32"});
  check_word("`order`", options.order, {"interleaved", "planar"});
  if (info.channels.empty()) throw usage_error("E0508", path).says("there is no channel to write");
  return format_to_write_of(path, options).write(path, info, options);
}

}  // namespace libchar
