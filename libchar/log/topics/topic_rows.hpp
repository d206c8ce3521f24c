#pragma once
// Rows of one topic of a log that holds several: what all TopicReaders have in common.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/log/topics/topic_reader.hpp"

namespace libchar {

// Which stream of a log with several is meant: by its name, by the channels asked for, or because there is only one.

struct TopicChoice {
  std::size_t topic = 0;
  std::vector<std::string> channels;  ///< `options.channels` without the topic's name in front
  std::string guess;                  ///< why this one was taken, when nobody said so
};

/// Nothing when there are several and nobody said which: `options` name none. Throws Error(usage)
/// for a topic or a channel that is not there, for channels of several topics (they have several
/// clocks), and for a topic without a number.
std::optional<TopicChoice> choose_topic(const std::vector<LogTopic>& topics, const ReadOptions& options,
                                        const std::string& file);

/// The topics that `options.topic` names where those are several, instances of one name or by a pattern, each with the
/// channels asked for of it (TOPIC/FIELD, FIELD or a pattern); without those that have none of them. Empty where one
/// topic is named. Throws Error(usage) for a word that no topic knows.
std::vector<TopicChoice> choose_topics(const std::vector<LogTopic>& topics, const ReadOptions& options,
                                       const std::string& file);

/// The one to look at first: of a sensor, with the most rows. There must be one.
const LogTopic& likely_topic(const std::vector<LogTopic>& topics);

/// The sentence for a log whose topic has to be chosen first, Error(usage), or that has none which
/// can be read, Error(input): what it lost (`losses`) may be the reason.
[[noreturn]] void refuse_without_topic(const std::vector<LogTopic>& topics, const std::string& file,
                                       const Findings& losses = {});

/// The rows of the topic and channels that `options` choose. Throws Error(usage) when they choose
/// none or several (E0425).
std::unique_ptr<RowSource> open_topic_rows(std::unique_ptr<TopicReader> reader, const std::string& path,
                                           std::string_view format, const ReadOptions& options);

}  // namespace libchar
