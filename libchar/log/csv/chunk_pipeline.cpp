#include "libchar/log/csv/chunk_pipeline.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

#include "libchar/core/process/thread_limit.hpp"

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

void ChunkPipeline::drive(int threads) {
  try {
    // TBB warns on stderr of more threads than there are cores.
    tbb::task_arena(std::min(threads, processors_given())).execute([this] { run(); });
  } catch (...) {  // no memory for a task
    failure_ = std::current_exception();
    done_.push(nullptr);
  }
}

void ChunkPipeline::run() {
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      items_.size(),
      tbb::make_filter<void, Item*>(filter_mode::serial_in_order, [&](tbb::flow_control& flow) {
        Item* const item = read();
        if (item == nullptr) flow.stop();
        return item;
      }) & tbb::make_filter<Item*, Item*>(filter_mode::serial_in_order, [&](Item* item) {
        chunks_.hash(item->raw);
        return item;
      }) & tbb::make_filter<Item*, Item*>(filter_mode::parallel, [&](Item* item) {
        parse(*item);
        return item;
      }) & tbb::make_filter<Item*, void>(filter_mode::serial_in_order, [&](Item* item) {
        done_.push(item);
      }));
}

// The next chunk, as soon as an item is free: so chunks that the caller has not taken do not pile up.
ChunkPipeline::Item* ChunkPipeline::read() {
  Item* item = nullptr;
  if (!stop_) item = free_.pop();
  if (item == nullptr || stop_) return nullptr;
  try {
    item->last = !chunks_.next(item->raw);
  } catch (...) {
    item->failure = std::current_exception();
    item->last = true;
  }
  if (item->last) stop_ = true;  // never back to false: the caller sets it, too, at any time
  return item;
}

void ChunkPipeline::parse(Item& item) const {
  if (item.last) return;
  try {
    parse_rows(item.raw.text(), plan_, item.chunk);
  } catch (...) {
    item.failure = std::current_exception();
    item.last = true;
  }
}

}  // namespace libchar::csv
