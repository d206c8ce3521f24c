#include "libchar/log/ros/chunked_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/ros/decompress.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLargestExample = std::size_t{1} << 20U;
constexpr std::uint64_t kEnoughForRate = 20;
constexpr std::uint64_t kExampleBytes = std::uint64_t{32} << 20U;  // looked through for first messages

double rate_seen(const StreamCount& count) {
  const double seconds = (static_cast<double>(count.last_seen_ns) - static_cast<double>(count.first_seen_ns)) * 1e-9;
  return count.seen >= kEnoughForRate && seconds > 0 ? static_cast<double>(count.seen - 1) / seconds : 0;
}

}  // namespace

void ChunkScan::begin_at(std::uint64_t at) {
  at_ = at;
  chunk_ = {};
  single_ = ended_ = false;
}

void ChunkScan::only(std::vector<bool> streams, std::vector<std::uint64_t> skip) {
  streams_ = std::move(streams);
  skip_ = std::move(skip);
}

bool ChunkScan::next(RawMessage& message, StreamId& stream, Findings& warnings) {
  for (;;) {
    while (!chunk_.empty())
      if (chunk_record(message, stream, warnings)) return true;
    if (ended_) return false;
    const Step step = file_record(message, stream, warnings);
    if (step == Step::message) return true;
    if (step == Step::end) ended_ = true;
  }
}

bool ChunkScan::enters(std::uint64_t at) {
  chunk_at_ = at;
  return !std::binary_search(skip_.begin(), skip_.end(), at);
}

void ChunkScan::note_packing(const std::string& method, std::uint64_t bytes, const char* rewrite, const char* unpack) {
  const std::string name = method.empty() ? "none" : printable(method, 40);
  if (packed_with_.find(name) == std::string::npos) packed_with_ += (packed_with_.empty() ? "" : ", ") + name;
  const auto refusal = [&](const char* code) {
    return input_error(code, fmt::format("{} (byte {})", file_.path(), chunk_at_));
  };
  if (bytes > kLargestChunk)
    throw refusal("E0443")
        .says("a chunk of {} bytes, more than the limit of {}", bytes, kLargestChunk)
        .hint("write it again with smaller chunks ({})", rewrite);
  if (std::string why = why_not_packed(method); !why.empty())
    throw refusal("E0442").says(std::move(why)).hint("write it again without ({})", unpack);
}

void ChunkScan::lose_chunk(Findings& warnings, const char* what, const std::string& why) {
  warnings.add("broken_chunk", fmt::format("chunks that are broken (cannot be unpacked, or {}) were left out", what),
               fmt::format("byte {}{}{}", chunk_at_, why.empty() ? "" : ": ", why));
  chunk_ = {};
}

ChunkScan::Step ChunkScan::cut(Findings& warnings, std::string_view inside, std::uint64_t at) const {
  warnings.add("cut_end",
               fmt::format("the file ends at byte {} {} (a recording that was not closed, or a copy that was cut): "
                           "only what is whole is read",
                           file_.size(), inside),
               at < file_.size() ? fmt::format("which begins at byte {}", at) : std::string());
  return Step::end;
}

std::string ChunkedTopics::packing() const {
  const std::string& packed = scan_.packed_with();
  return packed.empty() ? "" : ", chunks packed with " + packed;
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
  scan_.begin_at(first_record_);
  RawMessage message;
  StreamId stream = 0;
  while (scan_.next(message, stream, found_listing())) {
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
    const bool looked_for =
        std::any_of(chunk.streams.begin(), chunk.streams.end(), [&](StreamId id) { return lacks_example(id); });
    if (!looked_for || chunk.at < first_record_) continue;
    scan_.begin_at(chunk.at);
    scan_.stop_behind_chunk();
    while (scan_.next(message, stream, found_listing())) look_at(stream, message);
    for (auto& [id, count] : counts_) count.piece_ended = count.seen > 0;
  }
  const auto lacking = [&] {
    return std::any_of(counts_.begin(), counts_.end(), [&](const auto& count) { return lacks_example(count.first); });
  };
  if (!lacking()) return;
  scan_.begin_at(first_record_);
  while (scan_.at() < kExampleBytes && scan_.next(message, stream, found_listing())) {
    if (!lacks_example(stream)) continue;
    look_at(stream, message);
    if (!lacking()) return;
  }
}

void ChunkedTopics::list_topics(std::vector<std::pair<StreamId, RawTopic>> streams) {
  RawTopics raw;
  for (auto& [id, topic] : streams) {
    if (const auto count = counts_.find(id); count != counts_.end()) {
      topic.rows = count->second.rows;
      topic.first_ns = count->second.first_ns;
      topic.last_ns = count->second.last_ns;
      topic.rate_hz = rate_seen(count->second);
      topic.format.example = std::move(count->second.example);
    }
    const std::size_t at = raw.add(std::move(topic));
    if (at == streams_.size()) streams_.emplace_back();
    streams_[at].push_back(id);
  }
  counts_.clear();
  set_topics(raw.take());
}

void ChunkedTopics::start(std::size_t topic) {
  chosen_ = topic;
  std::vector<bool> wanted(std::size_t{1} << 16U, false);
  for (const StreamId id : streams_[topic]) wanted[id] = true;
  std::vector<std::uint64_t> skip;
  for (const ChunkPlace& chunk : chunks_)
    if (!chunk.streams.empty() &&
        std::none_of(chunk.streams.begin(), chunk.streams.end(), [&](StreamId id) { return wanted[id]; }))
      skip.push_back(chunk.at);
  std::sort(skip.begin(), skip.end());
  scan_.only(std::move(wanted), std::move(skip));
  scan_.begin_at(first_record_);
}

bool ChunkedTopics::next_message(RawMessage& message, Findings& warnings) {
  StreamId stream = 0;
  if (scan_.next(message, stream, warnings)) {
    ++seen_;
    return true;
  }
  ended_ = true;
  return false;
}

void ChunkedTopics::finish(Findings& warnings) {
  MessageTopics::finish(warnings);
  if (!ended_) return;
  const LogTopic& topic = topics()[chosen_];
  if (seen_ < topic.rows)
    warnings.add(
        "lost_messages",
        fmt::format("messages of {} that the file's index counts and that are not there", printable(topic.name)), "",
        topic.rows - seen_);
}

}  // namespace libchar
