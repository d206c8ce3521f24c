#pragma once
// Chunks of a CSV file parsed in parallel and handed out in file order; a stage of its own hashes
// them in that order. A thread drives the pipeline ahead of the caller.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "libchar/log/csv/chunk_reader.hpp"
#include "libchar/log/csv/head/plan.hpp"
#include "libchar/log/csv/rows/rows.hpp"

namespace libchar::csv {

/// A queue between threads that takes all its memory when it is made: where memory runs out, the
/// end of the pipeline must still get through.
template <class T>
class FixedQueue {
 public:
  explicit FixedQueue(std::size_t most) : ring_(most) {}
  /// Never more than `most` at once.
  void push(T value) {
    {
      const std::lock_guard lock(mutex_);
      ring_[(first_ + count_++) % ring_.size()] = value;
    }
    filled_.notify_one();
  }
  /// Waits for one.
  T pop() {
    std::unique_lock lock(mutex_);
    filled_.wait(lock, [&] { return count_ > 0; });
    const T value = ring_[first_];
    first_ = (first_ + 1) % ring_.size();
    --count_;
    return value;
  }

 private:
  std::mutex mutex_;
  std::condition_variable filled_;
  std::vector<T> ring_;
  std::size_t first_ = 0, count_ = 0;
};

/// `chunks` and `plan` must outlive it.
class ChunkPipeline {
 public:
  ChunkPipeline(ChunkReader& chunks, const Plan& plan, int threads);
  ChunkPipeline(const ChunkPipeline&) = delete;
  ChunkPipeline& operator=(const ChunkPipeline&) = delete;
  ~ChunkPipeline() { stop(); }

  /// The next chunk and its offset in the file; false behind the last. What reading or parsing
  /// threw is thrown here, in the chunk's turn.
  bool next(ParsedChunk& chunk, std::uint64_t& offset);
  /// Ends the pipeline; what was read is hashed, and no chunk comes after that.
  void stop();

 private:
  struct Item {
    RawChunk raw;
    ParsedChunk chunk;
    bool last = false;  // nothing stands behind it: the end of the file, or a failure
    std::exception_ptr failure;
  };
  void drive(int threads);
  void run();
  Item* read();
  void parse(Item& item) const;

  ChunkReader& chunks_;
  const Plan& plan_;
  std::vector<Item> items_;        // as many as may be under way or wait for the caller
  FixedQueue<Item*> free_, done_;  // nullptr in free_: the end is asked for
  std::atomic<bool> stop_ = false;
  bool ended_ = false;
  std::exception_ptr failure_;  // of the pipeline itself
  std::thread driver_;          // the last: it uses all of the above
};

}  // namespace libchar::csv
