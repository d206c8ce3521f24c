#include "libchar/log/ros/chunked_topics.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLargestExample = std::size_t{1} << 20U;
constexpr std::uint64_t kEnoughForRate = 20;
constexpr std::uint64_t kExampleBytes = std::uint64_t{32}
                                        << 20U;  // looked through for first messages

double rate_seen(const StreamCount& count) {
  const double seconds =
      (static_cast<double>(count.last_seen_ns) - static_cast<double>(count.first_seen_ns)) * 1e-9;
  return count.seen >= kEnoughForRate && seconds > 0 ? static_cast<double>(count.seen - 1) / seconds
                                                     : 0;
}

}  // namespace

void add_cut_end(Warnings& warnings,
                 std::uint64_t size,
                 std::string_view inside,
                 std::uint64_t at) {
  warnings.add("cut_end",
               fmt::format("the file ends at byte {} {} (a recording that was not closed, or a "
                           "copy that was cut): only what is whole is read",
                           size,
                           inside),
               at < size ? fmt::format("which begins at byte {}", at) : std::string());
}

void ChunkedTopics::look_at(StreamId stream, const RawMessage& message) {
  StreamCount& count = counts_[stream];
  if (!count.piece_ended) {
    if (count.seen++ == 0) count.first_seen_ns = message.log_ns;
    count.last_seen_ns = message.log_ns;
  }
  if (count.example.empty() && message.data.size() <= kLargestExample)
    count.example.assign(message.data.begin(), message.data.end());
}

bool ChunkedTopics::lacks_example(StreamId stream) const {
  const auto found = counts_.find(stream);
  return found != counts_.end() && found->second.rows > 0 && found->second.example.empty();
}

void ChunkedTopics::count_messages() {
  scan().begin_at(first_record());
  RawMessage message;
  StreamId stream = 0;
  while (scan().next(message, stream, found_listing())) {
    StreamCount& count = counts_[stream];
    count.first_ns = count.rows == 0 ? message.log_ns : std::min(count.first_ns, message.log_ns);
    count.last_ns = count.rows == 0 ? message.log_ns : std::max(count.last_ns, message.log_ns);
    ++count.rows;
    look_at(stream, message);
  }
}

// The first message of each stream: from the chunks that the index names, or the beginning of the file.
void ChunkedTopics::find_examples() {
  RawMessage message;
  StreamId stream = 0;
  for (const ChunkPlace& chunk : chunks_) {
    const bool looked_for = std::any_of(
        chunk.streams.begin(), chunk.streams.end(), [&](StreamId id) { return lacks_example(id); });
    if (!looked_for || chunk.at < first_record()) continue;
    scan().begin_at(chunk.at);
    scan().stop_behind_chunk();
    while (scan().next(message, stream, found_listing())) look_at(stream, message);
    for (auto& [id, count] : counts_) count.piece_ended = count.seen > 0;
  }
  const auto lacking = [&] {
    return std::any_of(counts_.begin(), counts_.end(), [&](const auto& count) {
      return lacks_example(count.first);
    });
  };
  if (!lacking()) return;
  scan().begin_at(first_record());
  while (scan().at() < kExampleBytes && scan().next(message, stream, found_listing())) {
    if (!lacks_example(stream)) continue;
    look_at(stream, message);
    if (!lacking()) return;
  }
}

void ChunkedTopics::list_topics(std::vector<std::pair<StreamId, RawTopic>> streams) {
  std::vector<RawTopic> raw;
  for (auto& [id, topic] : streams) {
    if (const auto count = counts_.find(id); count != counts_.end()) {
      topic.rows = count->second.rows;
      topic.first_ns = count->second.first_ns;
      topic.last_ns = count->second.last_ns;
      topic.rate_hz = rate_seen(count->second);
      topic.format.example = std::move(count->second.example);
    }
    const std::size_t at = merge_topic(raw, std::move(topic));
    if (at == streams_.size()) streams_.emplace_back();
    streams_[at].push_back(id);
  }
  counts_.clear();
  set_topics(std::move(raw));
}

void ChunkedTopics::start(std::size_t topic) {
  chosen_ = topic;
  std::vector<bool> wanted(std::size_t{1} << 16U, false);
  for (const StreamId id : streams_[topic]) wanted[id] = true;
  std::vector<std::uint64_t> skip;
  for (const ChunkPlace& chunk : chunks_)
    if (!chunk.streams.empty() &&
        std::none_of(
            chunk.streams.begin(), chunk.streams.end(), [&](StreamId id) { return wanted[id]; }))
      skip.push_back(chunk.at);
  std::sort(skip.begin(), skip.end());
  scan().only(std::move(wanted), std::move(skip));
  scan().begin_at(first_record());
}

bool ChunkedTopics::next_message(RawMessage& message, Warnings& warnings) {
  StreamId stream = 0;
  if (scan().next(message, stream, warnings)) {
    ++seen_;
    return true;
  }
  ended_ = true;
  return false;
}

void ChunkedTopics::finish(Warnings& warnings) {
  MessageTopics::finish(warnings);
  if (!ended_) return;
  const LogTopic& topic = topics()[chosen_];
  if (seen_ < topic.rows)
    warnings.add("lost_messages",
                 fmt::format("messages of {} that the file's index counts and that are not there",
                             printable(topic.name)),
                 "",
                 topic.rows - seen_);
}

}  // namespace libchar
