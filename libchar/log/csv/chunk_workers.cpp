#include "libchar/log/csv/chunk_workers.hpp"

#include <utility>

#include "libchar/core/sha256_blocks.hpp"

namespace libchar::csv {

ChunkWorkers::ChunkWorkers(ChunkReader& chunks, const Plan& plan, int threads)
    : chunks_(chunks),
      plan_(plan),
      room_(static_cast<std::size_t>(threads) + 2),
      interleave_(chunks.interleaves_hash()) {
  for (int i = 0; i < threads; ++i) workers_.emplace_back([this] { work(); });
}

bool ChunkWorkers::next(ParsedChunk& chunk, std::uint64_t& offset) {
  std::unique_lock lock(mutex_);
  if (ended_) return false;
  spare_chunks_.push_back(std::move(chunk));
  done_changed_.wait(lock, [&] { return done_.count(delivered_) > 0; });
  auto node = done_.extract(delivered_);
  ++delivered_;
  room_changed_.notify_one();
  Done& item = node.mapped();
  if (item.end || item.failure) ended_ = true;
  if (item.failure) std::rethrow_exception(item.failure);
  if (item.end) return false;
  chunk = std::move(item.chunk);
  offset = item.offset;
  return true;
}

void ChunkWorkers::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    room_changed_.notify_all();
  }
  for (std::thread& worker : workers_) worker.join();
  workers_.clear();
  ended_ = true;
}

void ChunkWorkers::finish_hash() {
  stop();
  for (auto& [sequence, raw] : unhashed_) chunks_.hash(raw);
  unhashed_.clear();
}

void ChunkWorkers::work() {
  for (;;) {
    Job job;
    if (!begin(job)) return;
    read(job);
    parse(job);
    deliver(std::move(job));
    hash_in_order();
  }
}

// Waits for a turn to read; false when there is nothing left to do.
bool ChunkWorkers::begin(Job& job) {
  std::unique_lock lock(mutex_);
  // Neither the parsed chunks nor those that wait for their hash may pile up.
  room_changed_.wait(lock, [&] {
    const bool room = read_ < delivered_ + room_ && read_ < hashed_ + 2 * room_;
    // A chunk can be hashed between the steps of its parsing only when its turn has come, and what
    // others have parsed by then costs its hash on top.
    const bool turn = !interleave_ || parsing_ == 0;
    return stop_ || exhausted_ || (!reading_ && room && turn);
  });
  if (stop_ || exhausted_) return false;
  reading_ = true;  // one reader at a time, in file order
  job.sequence = read_++;
  ++parsing_;
  if (!spare_raws_.empty()) {
    job.raw = std::move(spare_raws_.back());
    spare_raws_.pop_back();
  }
  if (!spare_chunks_.empty()) {
    job.done.chunk = std::move(spare_chunks_.back());
    spare_chunks_.pop_back();
  }
  return true;
}

void ChunkWorkers::read(Job& job) {
  try {
    job.done.end = !chunks_.next(job.raw);
  } catch (...) {
    job.done.failure = std::current_exception();
  }
  job.done.offset = job.raw.offset;
  const std::lock_guard lock(mutex_);
  reading_ = false;
  exhausted_ = exhausted_ || job.done.end || job.done.failure;
  job.hashing = chunks_.interleaves_hash() && !hashing_ && hashed_ == job.sequence;
  hashing_ = hashing_ || job.hashing;
  room_changed_.notify_all();
}

void ChunkWorkers::parse(Job& job) {
  Sha256Blocks* const hash = job.hashing ? chunks_.begin_hash(job.raw) : nullptr;
  if (!job.done.end && !job.done.failure) {
    try {
      parse_rows(job.raw.text(), plan_, job.done.chunk, hash);
    } catch (...) {
      job.done.failure = std::current_exception();
    }
  }
  if (!job.hashing) return;
  // Unusual rows are parsed without hashing in between: then all workers parse at once.
  job.interleaved_enough =
      2 * (hash->end - hash->next) <= static_cast<std::ptrdiff_t>(job.raw.size);
  chunks_.end_hash(job.raw);
}

void ChunkWorkers::deliver(Job job) {
  const std::lock_guard lock(mutex_);
  if (job.hashing) interleave_ = job.interleaved_enough;
  done_.emplace(job.sequence, std::move(job.done));
  if (job.hashing)
    note_hashed(std::move(job.raw));
  else
    unhashed_.emplace(job.sequence, std::move(job.raw));
  --parsing_;
  done_changed_.notify_one();
  room_changed_.notify_one();
}

// Whoever comes by hashes what is next in line; nobody waits for it.
void ChunkWorkers::hash_in_order() {
  for (;;) {
    RawChunk raw;
    {
      const std::lock_guard lock(mutex_);
      if (hashing_ || unhashed_.empty() || unhashed_.begin()->first != hashed_) return;
      hashing_ = true;
      raw = std::move(unhashed_.begin()->second);
      unhashed_.erase(unhashed_.begin());
    }
    chunks_.hash(raw);
    const std::lock_guard lock(mutex_);
    note_hashed(std::move(raw));
  }
}

// Under the lock.
void ChunkWorkers::note_hashed(RawChunk raw) {
  raw.hash_from = raw.hash_to = raw.nuls_after = 0;
  spare_raws_.push_back(std::move(raw));
  ++hashed_;
  hashing_ = false;
  room_changed_.notify_one();
}

}  // namespace libchar::csv
