#include "libchar/log/write.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/log/write/log_writers.hpp"

namespace libchar {
namespace {

struct Written {
  std::string_view name;
  std::vector<std::string> suffixes;  // what "auto" goes by
  std::unique_ptr<LogWriter> (*open)(const std::string&, const LogInfo&, const WriteOptions&);
};

const std::vector<Written>& written() {
  static const std::vector<Written> table = {{"csv", {".csv"}, write_csv},
                                             {"npy", {".npy"}, write_npy},
                                             {"raw", {".f64", ".f32", ".bin", ".raw"}, write_raw}};
  return table;
}

void check_word(const char* option, const std::string& got, const std::vector<std::string>& words) {
  if (std::find(words.begin(), words.end(), got) == words.end())
    throw Error({ErrorKind::usage,
                 "E0507",
                 option,
                 fmt::format("expected {}", fmt::join(words, " or ")),
                 got,
                 ""});
}

}  // namespace

bool unnamed(const std::vector<Channel>& channels) {
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (channels[i].name != fmt::format("c{}", i)) return false;
  return true;
}

std::string format_to_write(const std::string& path, const WriteOptions& options) {
  for (const Written& format : written()) {
    if (options.format == format.name) return options.format;
    const std::string suffix = std::filesystem::path(path).extension().string();
    if (options.format == "auto" &&
        std::find(format.suffixes.begin(), format.suffixes.end(), suffix) != format.suffixes.end())
      return std::string(format.name);
  }
  if (options.format == "auto")
    throw Error({ErrorKind::usage,
                 "E0506",
                 path,
                 "the suffix does not say which format to write",
                 "",
                 "end the name in .csv, .npy, .f64, .f32 or .bin, or name the format"});
  throw Error({ErrorKind::usage,
               "E0506",
               path,
               "no such format to write; csv, npy and raw are written",
               options.format,
               ""});
}

std::unique_ptr<LogWriter> open_log_writer(const std::string& path,
                                           const LogInfo& info,
                                           const WriteOptions& options) {
  check_word("dtype", options.dtype, {"f64", "f32"});
  check_word("order", options.order, {"interleaved", "planar"});
  if (info.channels.empty())
    throw Error({ErrorKind::usage, "E0508", path, "there is no channel to write", "", ""});
  const std::string name = format_to_write(path, options);
  const auto format = std::find_if(
      written().begin(), written().end(), [&](const Written& f) { return f.name == name; });
  return format->open(path, info, options);
}

}  // namespace libchar
