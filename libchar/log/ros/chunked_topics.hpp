#pragma once
// Topics of files whose messages stand in chunks: MCAP and bags. What is common once their records can be read: counts
// and first messages with or without an index, chunks that need not be looked into, and what is missing at the end.

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/log/ros/file_window.hpp"
#include "libchar/log/ros/messages/message_topics.hpp"

namespace libchar {

/// Channels of MCAP, connections of bags: every message is of one.
using StreamId = std::uint16_t;

/// Messages of a file in the order in which they stand there: its own, and those of the chunk that is being read.
class ChunkScan {
 public:
  explicit ChunkScan(MovingWindow& file) : file_(file) {}
  virtual ~ChunkScan() = default;
  /// From the record at this byte on, as if nothing had been read.
  virtual void begin_at(std::uint64_t at);
  /// Ends behind the record at which it was told to begin: for a look at a single chunk.
  void stop_behind_chunk() { single_ = true; }
  /// Only messages of these streams (all by default); chunks at the bytes of `skip`, which is
  /// sorted, are not looked into.
  void only(std::vector<bool> streams, std::vector<std::uint64_t> skip);
  /// The next message and its stream, false at the end.
  bool next(RawMessage& message, StreamId& stream, Findings& warnings);
  /// Byte up to which the file has been read.
  std::uint64_t at() const { return std::min(at_, file_.size()); }
  /// "" when no chunk was seen; "none", "lz4"…, as far as chunks were seen.
  const std::string& packed_with() const { return packed_with_; }

 protected:
  enum class Step { message, other, end };
  virtual Step file_record(RawMessage& message, StreamId& stream, Findings& warnings) = 0;
  /// One record of the chunk in memory: is it a message that is wanted?
  virtual bool chunk_record(RawMessage& message, StreamId& stream, Findings& warnings) = 0;

  bool wanted(StreamId stream) const { return streams_.empty() || streams_[stream]; }
  /// The chunk at this byte of the file is the one that is read from now on, unless it is one to be skipped.
  bool enters(std::uint64_t at);
  /// Notes how the chunk is packed. Throws Error(input) where it is too large, or cannot be unpacked by
  /// this program: `rewrite` and `unpack` write the file again.
  void note_packing(const std::string& method, std::uint64_t bytes, const char* rewrite, const char* unpack);
  void lose_chunk(Findings& warnings, const char* what, const std::string& why = "");
  /// Counts the end of a file that was never written, or copied, to its end: `inside` says of what
  /// ("inside a chunk", "without its index"), which begins at byte `at`.
  Step cut(Findings& warnings, std::string_view inside, std::uint64_t at) const;

  MovingWindow& file_;
  std::uint64_t at_ = 0;
  std::vector<std::byte> unpacked_;
  std::span<const std::byte> chunk_;  ///< what is left of the chunk that is being read
  std::uint64_t chunk_at_ = 0;
  bool single_ = false;

 private:
  bool ended_ = false;
  std::vector<bool> streams_;
  std::vector<std::uint64_t> skip_;
  std::string packed_with_;
};

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
  void finish(Findings& warnings) override;
  std::uint64_t bytes_read() const override { return scan_.at(); }

 protected:
  /// `scan`, of `file()`, need not be made yet.
  ChunkedTopics(const std::string& path, const ReadOptions& options, bool publishes, ChunkScan& scan,
                std::uint64_t first_record)
      : MessageTopics(path, options, publishes), file_(path), scan_(scan), first_record_(first_record) {}
  MovingWindow& file() { return file_; }
  /// ", chunks packed with zstd"; "" when none was seen.
  std::string packing() const;

  /// What the file's index says; then `find_examples`. Without one `count_messages`, which goes
  /// through everything once.
  std::vector<ChunkPlace>& chunks() { return chunks_; }
  std::map<StreamId, StreamCount>& counts() { return counts_; }
  void find_examples();
  void count_messages();
  /// Called once, last. Streams of one topic and type become one topic: publishers that took turns.
  void list_topics(std::vector<std::pair<StreamId, RawTopic>> streams);

  void start(std::size_t topic) override;
  bool next_message(RawMessage& message, Findings& warnings) override;

 private:
  void look_at(StreamId stream, const RawMessage& message);
  bool lacks_example(StreamId stream) const;

  MovingWindow file_;
  ChunkScan& scan_;
  std::uint64_t first_record_;
  std::vector<ChunkPlace> chunks_;
  std::map<StreamId, StreamCount> counts_;
  std::vector<std::vector<StreamId>> streams_;  // by topic
  std::size_t chosen_ = 0;
  std::uint64_t seen_ = 0;
  bool ended_ = false;
};

}  // namespace libchar
