#pragma once
// Rows of one topic of a log that holds several: what all TopicReaders have in common.

#include <memory>
#include <string>
#include <string_view>

#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/topics/topic_reader.hpp"

namespace libchar {

/// The rows of the topic and channels that `options` choose. Throws Error(usage) when they choose
/// none or several (E0425).
std::unique_ptr<RowSource> open_topic_rows(std::unique_ptr<TopicReader> reader,
                                           const std::string& path,
                                           std::string_view format,
                                           const ReadOptions& options);

}  // namespace libchar
