#pragma once
// One row of the table of log formats: its description and the functions behind it. A format
// exports its row and nothing else.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/topics/topic_reader.hpp"
#include "libchar/log/write.hpp"

namespace libchar {

struct Format {
  LogFormat about;
  /// Is a file of this format beyond doubt (a magic number that nothing else has), whatever it is
  /// called? Asked before suffixes; nullptr when no beginning is that clear.
  bool (*certain)(std::string_view first_bytes) = nullptr;
  /// Does a file look like this format? Asked when no suffix decides; nullptr where `certain` says all.
  bool (*sniff)(const std::string& path, std::string_view first_bytes) = nullptr;
  /// Of a format of one table; nullptr where `topics` is there.
  std::unique_ptr<RowSource> (*open)(const std::string& path, const ReadOptions& options) = nullptr;
  /// Of a format of several streams: topics/topic_rows.hpp makes rows of what it reads.
  std::unique_ptr<TopicReader> (*topics)(const std::string& path, const ReadOptions& options) = nullptr;
  /// nullptr for a format that is not written.
  std::unique_ptr<LogWriter> (*write)(const std::string& path, const LogInfo& info,
                                      const WriteOptions& options) = nullptr;
};

/// `Format::topics` by R(path, options).
template <class R>
std::unique_ptr<TopicReader> open_topics(const std::string& path, const ReadOptions& options) {
  return std::make_unique<R>(path, options);
}

/// Opens a file of this format, of one table or of several streams.
std::unique_ptr<RowSource> open_rows(const Format& format, const std::string& path, const ReadOptions& options);

/// The table, the most specific format first.
const std::vector<Format>& formats();

/// The row of this name, nullptr when there is none.
const Format* find_format(std::string_view name);

/// The first row with a suffix of `path`, in capitals or not; nullptr when there is none.
const Format* format_by_suffix(const std::string& path);
const Format* written_format_by_suffix(const std::string& path);

}  // namespace libchar
