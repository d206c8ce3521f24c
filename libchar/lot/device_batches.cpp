#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <set>
#include <unordered_map>

#include "libchar/core/text/pattern.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {
namespace {

struct NaturalOrder {
  bool operator()(const std::string& a, const std::string& b) const { return comes_before(a, b); }
};
using Words = std::set<std::string, NaturalOrder>;

std::string note_of(const std::map<std::string, Words, NaturalOrder>& several) {
  if (several.empty()) return "";
  constexpr std::size_t kNamed = 5;
  std::vector<std::string> named;
  for (const auto& [device, batches] : several) {
    if (named.size() == kNamed) break;
    std::vector<std::string> titles;
    for (const std::string& batch : batches) titles.push_back(batch_title(batch));
    named.push_back(fmt::format("{} ({})", device, fmt::join(titles, ", ")));
  }
  const std::string more = several.size() > kNamed ? fmt::format(" and {} more", several.size() - kNamed) : "";
  return fmt::format("{} recordings in several batches, and {} in the first of them: {}{}.",
                     several.size() == 1 ? "1 device has" : fmt::format("{} devices have", several.size()),
                     several.size() == 1 ? "counts" : "count", fmt::join(named, ", "), more);
}

}  // namespace

DeviceBatches device_batches(std::span<const DeviceRecord> records) {
  DeviceBatches out;
  out.device_of.reserve(records.size());
  std::unordered_map<std::string, std::size_t> known;
  std::map<std::size_t, Words> several;
  for (const DeviceRecord& one : records) {
    const auto [at, fresh] = known.try_emplace(one.type + '\0' + one.device, out.batch.size());
    const std::size_t device = at->second;
    out.device_of.push_back(device);
    if (fresh) out.batch.push_back(one.batch);
    std::string& batch = out.batch[device];
    if (one.batch.empty() || one.batch == batch) continue;
    if (batch.empty()) {
      batch = one.batch;
      continue;
    }
    several[device].insert({batch, one.batch});
    if (comes_before(one.batch, batch)) batch = one.batch;
  }
  std::map<std::string, Words, NaturalOrder> named;
  for (std::size_t r = 0; !several.empty() && r < records.size(); ++r)
    if (const auto at = several.find(out.device_of[r]); at != several.end())
      named[records[r].device].insert(at->second.begin(), at->second.end());
  out.note = note_of(named);
  return out;
}

std::string batch_title(const std::string& batch) { return batch.empty() ? "no batch" : "batch " + batch; }

}  // namespace libchar
