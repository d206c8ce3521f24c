#include "libchar/lot/detail/fleet_data.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>

#include "libchar/core/text/pattern.hpp"

namespace libchar {
namespace {

std::vector<std::string> in_natural_order(const std::set<std::string>& words) {
  std::vector<std::string> out(words.begin(), words.end());
  std::sort(out.begin(), out.end(), [](const std::string& a, const std::string& b) {
    return comes_before(a, b);
  });
  return out;
}

}  // namespace

Fleet fleet_of(std::span<const DeviceRecord> records, const FleetLotOptions& options) {
  Fleet out;
  out.records = records;
  out.sorted = sorted_records(records);
  out.groups = lot_groups(records, out.sorted);
  std::set<std::string> types, batches;
  for (const std::size_t r : out.sorted.first) types.insert(records[r].type);
  batches.insert(out.sorted.batch.begin(), out.sorted.batch.end());
  out.types = in_natural_order(types);
  out.batches = in_natural_order(batches);
  std::unordered_map<std::string, std::size_t> index;
  for (std::size_t b = 0; b < out.batches.size(); ++b) index[out.batches[b]] = b;
  for (const std::string& batch : out.sorted.batch) out.batch_of.push_back(index[batch]);
  out.limits = group_limits(out.groups, out.types, options.limits);
  return out;
}

LotPlace place_of(const LotGroup& group, std::uint32_t member) {
  const auto at = std::lower_bound(group.member.begin(), group.member.end(), member);
  return group.places[static_cast<std::size_t>(at - group.member.begin())];
}

}  // namespace libchar
