#include "libchar/log/formats.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/topics/joined_topics.hpp"

// The log formats, the most specific first. A line both declares the row that NAME's file exports and lists it:
// Format NAME_format().
#define LIBCHAR_LOG_FORMATS(FORMAT) \
  FORMAT(ulog)                      \
  FORMAT(dataflash)                 \
  FORMAT(npy)                       \
  FORMAT(mcap)                      \
  FORMAT(bag)                       \
  FORMAT(db3)                       \
  FORMAT(rosbag2)                   \
  FORMAT(npz)                       \
  FORMAT(hdf5)                      \
  FORMAT(matlab)                    \
  FORMAT(imu)                       \
  FORMAT(wav)                       \
  FORMAT(xlsx)                      \
  FORMAT(tables)                    \
  FORMAT(raw)                       \
  FORMAT(jsonl)                     \
  FORMAT(csv)

// A build may bring formats of its own, which are asked first: -D'LIBCHAR_MORE_LOG_FORMATS(FORMAT)=FORMAT(mine)'.
#ifndef LIBCHAR_MORE_LOG_FORMATS
#define LIBCHAR_MORE_LOG_FORMATS(FORMAT)
#endif

namespace libchar {

#define LIBCHAR_DECLARE(name) Format name##_format();
LIBCHAR_MORE_LOG_FORMATS(LIBCHAR_DECLARE)
LIBCHAR_LOG_FORMATS(LIBCHAR_DECLARE)
#undef LIBCHAR_DECLARE

const std::vector<Format>& formats() {
#define LIBCHAR_ROW(name) name##_format(),
  static const std::vector<Format> table = {LIBCHAR_MORE_LOG_FORMATS(LIBCHAR_ROW) LIBCHAR_LOG_FORMATS(LIBCHAR_ROW)};
#undef LIBCHAR_ROW
  return table;
}

namespace {

bool ends_in(std::string_view path, const std::vector<std::string_view>& suffixes) {
  return std::any_of(suffixes.begin(), suffixes.end(), [&](std::string_view suffix) {
    return path.size() > suffix.size() && ascii_lower(path.substr(path.size() - suffix.size())) == suffix;
  });
}

// In alphabetical order of their names.
std::vector<const Format*> by_name() {
  std::vector<const Format*> rows;
  for (const Format& format : formats()) rows.push_back(&format);
  std::sort(rows.begin(), rows.end(), [](const Format* a, const Format* b) { return a->about.name < b->about.name; });
  return rows;
}

}  // namespace

std::unique_ptr<RowSource> open_rows(const Format& format, const std::string& path, const ReadOptions& options) {
  if (format.topics == nullptr) return format.open(path, options);
  auto reader = format.topics(path, options);
  const auto several = choose_topics(reader->topics(), options, path);
  if (!several.empty())
    return open_joined_topics(several, reader->topics(), format.topics, path, format.about.name, options);
  return open_topic_rows(std::move(reader), path, format.about.name, options);
}

const Format* find_format(std::string_view name) {
  for (const Format& format : formats())
    if (format.about.name == name) return &format;
  return nullptr;
}

const Format* format_by_suffix(const std::string& path) {
  for (const Format& format : formats())
    if (ends_in(path, format.about.suffixes)) return &format;
  return nullptr;
}

const Format* written_format_by_suffix(const std::string& path) {
  for (const Format& format : formats())
    if (format.write && ends_in(path, format.about.written_suffixes)) return &format;
  return nullptr;
}

std::string readable_files() {
  std::vector<std::string_view> files;
  for (const Format* format : by_name()) {
    const LogFormat& about = format->about;
    if (!about.brief.empty() || !about.suffixes.empty())
      files.push_back(about.brief.empty() ? about.suffixes.front() : about.brief);
  }
  return fmt::format("{}", fmt::join(files, ", "));
}

std::vector<std::string> format_words() {
  std::vector<std::string> words = {"auto"};
  for (const Format* format : by_name()) words.emplace_back(format->about.name);
  return words;
}

std::vector<std::string> written_format_words() {
  std::vector<std::string> words = {"auto"};
  for (const Format* format : by_name())
    if (format->write) words.emplace_back(format->about.name);
  return words;
}

std::string written_suffixes() {
  std::vector<std::string_view> suffixes;
  for (const Format* format : by_name())
    if (format->write)
      suffixes.insert(suffixes.end(), format->about.written_suffixes.begin(), format->about.written_suffixes.end());
  return fmt::format("{}", fmt::join(suffixes, ", "));
}

}  // namespace libchar
