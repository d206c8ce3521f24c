#include "libchar/core/process/work.hpp"

#include <atomic>
#include <nlohmann/json.hpp>
#include <string>

namespace libchar {
namespace {

std::array<std::atomic<std::uint64_t>, std::tuple_size_v<WorkDone>> g_done{};

WorkDone all_done() {
  WorkDone out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = g_done[i].load(std::memory_order_relaxed);
  return out;
}

}  // namespace

Json work_json(const WorkDone& work) {
  Json out = Json::object();
  for (const auto& [kind, word] : enum_table<WorkKind>)
    if (const std::uint64_t count = work[static_cast<std::size_t>(kind)]; count > 0) out[std::string(word)] = count;
  return out;
}

void count_work(WorkKind kind, std::uint64_t more) {
  g_done[static_cast<std::size_t>(kind)].fetch_add(more, std::memory_order_relaxed);
}

WorkMeter::WorkMeter() : before_(all_done()) {}

WorkDone WorkMeter::done() const {
  WorkDone out = all_done();
  for (std::size_t i = 0; i < out.size(); ++i) out[i] -= before_[i];
  return out;
}

}  // namespace libchar
