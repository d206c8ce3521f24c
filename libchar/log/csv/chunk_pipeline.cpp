#include "libchar/log/csv/chunk_pipeline.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

#include "libchar/core/sha256_blocks.hpp"
#include "libchar/core/thread_limit.hpp"

namespace libchar::csv {

ChunkPipeline::ChunkPipeline(ChunkReader& chunks, const Plan& plan, int threads)
    : chunks_(chunks),
      plan_(plan),
      items_(static_cast<std::size_t>(threads) + 2),
      free_(items_.size() + 1),
      done_(items_.size() + 1) {
  for (Item& item : items_) free_.push(&item);
  driver_ = std::thread([this, threads] { drive(threads); });
}

bool ChunkPipeline::next(ParsedChunk& chunk, std::uint64_t& offset) {
  if (ended_) return false;
  Item* const item = done_.pop();
  ended_ = item == nullptr || item->last;
  if (item == nullptr) std::rethrow_exception(failure_);
  if (item->failure) std::rethrow_exception(item->failure);
  if (item->last) return false;
  std::swap(chunk, item->chunk);
  offset = item->raw.offset;
  free_.push(item);
  return true;
}

void ChunkPipeline::stop() {
  ended_ = true;
  if (!driver_.joinable()) return;
  stop_ = true;
  free_.push(nullptr);  // wakes the reader where no item is free
  driver_.join();
}

// While hashing goes along with parsing there is work for one thread: further ones would only wait for it, and TBB's wait busily.
void ChunkPipeline::drive(int threads) {
  try {
    if (chunks_.interleaves_hash()) tbb::task_arena(1).execute([this] { run(true); });
    // TBB warns on stderr of more threads than there are cores.
    if (!stop_)
      tbb::task_arena(std::min(threads, processors_given())).execute([this] { run(false); });
  } catch (...) {  // no memory for a task
    failure_ = std::current_exception();
    done_.push(nullptr);
  }
}

void ChunkPipeline::run(bool while_usual) {
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      while_usual ? 1 : items_.size(),
      tbb::make_filter<void, Item*>(filter_mode::serial_in_order, [&](tbb::flow_control& flow) {
        Item* item = nullptr;
        if (!while_usual || usual_) item = read();
        if (item == nullptr) flow.stop();
        return item;
      }) & tbb::make_filter<Item*, Item*>(filter_mode::serial_in_order, [&](Item* item) {
        parse_while_hashing(*item);
        return item;
      }) & tbb::make_filter<Item*, Item*>(filter_mode::parallel, [&](Item* item) {
        if (!item->parsed) parse(*item, nullptr);
        return item;
      }) & tbb::make_filter<Item*, void>(filter_mode::serial_in_order, [&](Item* item) {
        hand_out(*item);
      }));
}

// The next chunk, as soon as an item is free: so neither the parsed chunks nor those that wait for their hash pile up.
ChunkPipeline::Item* ChunkPipeline::read() {
  Item* item = nullptr;
  if (!stop_) item = free_.pop();
  if (item == nullptr || stop_) return nullptr;
  item->sequence = read_++;
  item->parsed = item->hashed = false;
  try {
    item->last = !chunks_.next(item->raw);
  } catch (...) {
    item->failure = std::current_exception();
    item->last = true;
  }
  if (item->last) stop_ = true;  // never back to false: the caller sets it, too, at any time
  return item;
}

// Where the processor hashes beside other work, the hash is nearly free inside the parsing; that takes one chunk after the other,
// and pays only while their rows are parsed that way. Otherwise the chunk goes on to be parsed beside others.
void ChunkPipeline::parse_while_hashing(Item& item) {
  if (!chunks_.interleaves_hash() || hashed_ != item.sequence) return;
  if (!std::exchange(usual_, true)) return;
  Sha256Blocks* const hash = chunks_.begin_hash(item.raw);
  parse(item, hash);
  usual_ = 2 * (hash->end - hash->next) <= static_cast<std::ptrdiff_t>(item.raw.size);
  chunks_.end_hash(item.raw);
  item.hashed = true;
  ++hashed_;
}

void ChunkPipeline::parse(Item& item, Sha256Blocks* hash) const {
  item.parsed = true;
  if (item.last) return;
  try {
    parse_rows(item.raw.text(), plan_, item.chunk, hash);
  } catch (...) {
    item.failure = std::current_exception();
    item.last = true;
  }
}

void ChunkPipeline::hand_out(Item& item) {
  if (!item.hashed) {
    chunks_.hash(item.raw);
    ++hashed_;
  }
  item.raw.hash_from = item.raw.hash_to = item.raw.nuls_after = 0;
  done_.push(&item);
}

}  // namespace libchar::csv
