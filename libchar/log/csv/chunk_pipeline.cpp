#include "libchar/log/csv/chunk_pipeline.hpp"

#include <algorithm>
#include <utility>

#include "libchar/core/parallel/parallel.hpp"

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
    parallel::Threads(threads).run([this] { run(); });
  } catch (...) {  // no memory for a task
    failure_ = std::current_exception();
    done_.push(nullptr);
  }
}

void ChunkPipeline::run() {
  const auto item_of = [](void* item) { return static_cast<Item*>(item); };
  parallel::in_order(items_.size(), {.read = [&]() -> void* { return read(); },
                                     .first = [&](void* item) { chunks_.hash(item_of(item)->raw); },
                                     .work = [&](void* item) { parse(*item_of(item)); },
                                     .last = [&](void* item) { done_.push(item_of(item)); }});
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
