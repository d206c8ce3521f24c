#pragma once
// Chunks of a CSV file parsed side by side and handed out in file order, with the hash of the file taken in order behind the
// parsing.
//
// Threads of our own and not tbb::parallel_pipeline: a pipeline runs until it has pushed everything, while rows are pulled here
// by a caller who may stop at any block, so it would need a thread and a queue besides; and its stages cannot be told to parse
// one chunk at a time as long as the hash is taken between the steps of that parsing, which is nearly free on one core.

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "libchar/log/csv/chunk_reader.hpp"
#include "libchar/log/csv/plan.hpp"
#include "libchar/log/csv/rows.hpp"

namespace libchar::csv {

/// `chunks` and `plan` must outlive it. Every worker takes the next chunk, parses it, and hashes what is next in line.
class ChunkWorkers {
 public:
  ChunkWorkers(ChunkReader& chunks, const Plan& plan, int threads);
  ChunkWorkers(const ChunkWorkers&) = delete;
  ChunkWorkers& operator=(const ChunkWorkers&) = delete;
  ~ChunkWorkers() { stop(); }

  /// The next chunk and its offset in the file; false behind the last. What a worker threw is thrown here, in the chunk's turn.
  bool next(ParsedChunk& chunk, std::uint64_t& offset);
  /// Ends the workers; no chunk comes after that.
  void stop();
  /// Stops, and hashes what was read and is not hashed yet.
  void finish_hash();

 private:
  struct Done {
    ParsedChunk chunk;
    std::uint64_t offset = 0;
    bool end = false;
    std::exception_ptr failure;
  };
  struct Job {
    std::uint64_t sequence = 0;
    RawChunk raw;
    Done done;
    bool hashing = false;             // between the steps of its parsing
    bool interleaved_enough = false;  // most of its hash was taken that way
  };
  void work();
  bool begin(Job& job);
  void read(Job& job);
  void parse(Job& job);
  void deliver(Job job);
  void hash_in_order();
  void note_hashed(RawChunk raw);

  ChunkReader& chunks_;
  const Plan& plan_;
  const std::size_t room_;  // parsed chunks that may wait
  std::mutex mutex_;
  std::condition_variable room_changed_, done_changed_;
  std::map<std::uint64_t, Done> done_;
  std::map<std::uint64_t, RawChunk> unhashed_;
  std::vector<RawChunk> spare_raws_;
  std::vector<ParsedChunk> spare_chunks_;
  std::uint64_t read_ = 0, delivered_ = 0, hashed_ = 0;
  int parsing_ = 0;  // workers between their read and their rows
  bool stop_ = false, exhausted_ = false, reading_ = false, hashing_ = false, interleave_ = false,
       ended_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace libchar::csv
