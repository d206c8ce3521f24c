#pragma once
// Topics of files whose messages stand in chunks: MCAP and bags. What is common once their records
// can be read: counts and first messages with or without an index, chunks that need not be looked
// into, and what is missing at the end.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/log/ros/messages/message_topics.hpp"

namespace libchar {

/// Channels of MCAP, connections of bags: every message is of one.
using StreamId = std::uint16_t;

/// Messages of a file in the order in which they stand there.
class MessageScan {
 public:
  virtual ~MessageScan() = default;
  /// From the record at this byte on, as if nothing had been read.
  virtual void begin_at(std::uint64_t at) = 0;
  /// Ends behind the record at which it was told to begin: for a look at a single chunk.
  virtual void stop_behind_chunk() = 0;
  /// Only messages of these streams (all by default); chunks at the bytes of `skip`, which is
  /// sorted, are not looked into.
  virtual void only(std::vector<bool> streams, std::vector<std::uint64_t> skip) = 0;
  /// The next message and its stream, false at the end.
  virtual bool next(RawMessage& message, StreamId& stream, Warnings& warnings) = 0;
  /// Byte up to which the file has been read.
  virtual std::uint64_t at() const = 0;
};

/// Counts the end of a file of `size` bytes that was never written, or copied, to its end: `inside`
/// says of what ("inside a chunk", "without its index"), which begins at byte `at`.
void add_cut_end(Warnings& warnings, std::uint64_t size, std::string_view inside, std::uint64_t at);

struct ChunkPlace {
  std::uint64_t at = 0;
  std::vector<StreamId> streams;  ///< that have messages in it; empty = not known
};

struct StreamCount {
  std::uint64_t rows = 0;
  std::int64_t first_ns = 0, last_ns = 0;
  std::vector<std::byte> example;
  /// of a piece of the file that was gone through, for a rate where first and last are those of chunks
  std::uint64_t seen = 0;
  bool piece_ended = false;
  std::int64_t first_seen_ns = 0, last_seen_ns = 0;
};

class ChunkedTopics : public MessageTopics {
 public:
  void finish(Warnings& warnings) override;
  std::uint64_t bytes_read() const override { return scan().at(); }

 protected:
  using MessageTopics::MessageTopics;
  virtual MessageScan& scan() = 0;
  virtual const MessageScan& scan() const = 0;
  virtual std::uint64_t first_record() const = 0;

  /// What the file's index says; then `find_examples`. Without one `count_messages`, which goes
  /// through everything once.
  std::vector<ChunkPlace>& chunks() { return chunks_; }
  std::map<StreamId, StreamCount>& counts() { return counts_; }
  void find_examples();
  void count_messages();
  /// Called once, last. Streams of one topic and type become one topic: publishers that took turns.
  void list_topics(std::vector<std::pair<StreamId, RawTopic>> streams);

  void start(std::size_t topic) override;
  bool next_message(RawMessage& message, Warnings& warnings) override;

 private:
  void look_at(StreamId stream, const RawMessage& message);
  bool lacks_example(StreamId stream) const;

  std::vector<ChunkPlace> chunks_;
  std::map<StreamId, StreamCount> counts_;
  std::vector<std::vector<StreamId>> streams_;  // by topic
  std::size_t chosen_ = 0;
  std::uint64_t seen_ = 0;
  bool ended_ = false;
};

}  // namespace libchar
