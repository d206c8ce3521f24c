#pragma once
// Several topics of one log, or instances of one sensor, as one recording.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/topics/topic_rows.hpp"

namespace libchar {

using OpenTopics = std::unique_ptr<TopicReader> (*)(const std::string& path, const ReadOptions& options);

/// Rows of a kind of their own, with what their channels are called among those of others.
struct JoinedRows {
  std::unique_ptr<RowSource> rows;
  std::string name;
  std::vector<std::string> channels;
};

/// These as one recording. A row holds the samples of one instant, at the stamp of the fastest; with `own_stamps` each
/// stamp has a row.
std::unique_ptr<RowSource> join_rows(std::vector<JoinedRows> kinds, const ReadOptions& options);

/// Rows with the channels TOPIC/FIELD of all that `chosen` names, each read by a reader of its own. Throws
/// Error(usage) for topics without stamps.
std::unique_ptr<RowSource> open_joined_topics(const std::vector<TopicChoice>& chosen, const std::vector<LogTopic>& all,
                                              const OpenTopics& open, const std::string& path, std::string_view format,
                                              const ReadOptions& options);

}  // namespace libchar
