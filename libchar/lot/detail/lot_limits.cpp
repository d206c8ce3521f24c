#include "libchar/lot/detail/lot_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

const NoiseLimits* limits_of(const std::string& type,
                             const std::map<std::string, NoiseLimits>& limits) {
  auto at = limits.find(type);
  if (at == limits.end()) at = limits.find("");
  return at == limits.end() ? nullptr : &at->second;
}

void check_types(const std::vector<std::string>& types,
                 const std::map<std::string, NoiseLimits>& limits) {
  for (const auto& [type, file] : limits)
    if (!type.empty() && std::find(types.begin(), types.end(), type) == types.end())
      throw Error({ErrorKind::usage,
                   "E0751",
                   file.file,
                   "limits of a type that no device of the fleet is of",
                   type,
                   fmt::format("the types are {}", fmt::join(types, ", "))});
}

/// How bad the news is: of several recordings the worst counts.
int rank_of(LimitStatus status) {
  return status == LimitStatus::fail ? 2 : status == LimitStatus::not_decided ? 1 : 0;
}

LimitFailure failure_of(const LotGroup& group, const Coefficient& found, const GroupLimit& limit) {
  LimitFailure out;
  const double value = found.value.value_or(limit.most);
  // Without a standard deviation the interval, which lies above the limit, says it.
  const double sd =
      found.relative_sd > 0 ? found.relative_sd : std::log(value / found.ci95.low) / kNormal95;
  out.deviation = std::log(value / limit.most) / std::max(sd, 1e-9);
  out.p = std::erfc(out.deviation / std::sqrt(2.0)) / 2;
  const DeviceQuantity quantity = quantity_of(limit.term);
  const std::string unit = unit_of(quantity, group.channel_unit);
  out.sentence = fmt::format("{}: {} {} {}, allowed {}.",
                             group.name,
                             title_of(quantity),
                             coefficient_text(found),
                             unit,
                             limit_text(limit.text, limit.most, unit));
  return out;
}

}  // namespace

std::vector<GroupLimit> group_limits(const std::vector<LotGroup>& groups,
                                     const std::vector<std::string>& types,
                                     const std::map<std::string, NoiseLimits>& limits) {
  check_types(types, limits);
  std::vector<GroupLimit> out;
  for (const std::string& type : types) {
    const NoiseLimits* file = limits_of(type, limits);
    if (file == nullptr) continue;
    std::vector<NamedChannel> names;
    std::vector<std::size_t> index;
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (!groups[g].of_kind && groups[g].type == type) {
        names.push_back({groups[g].name, groups[g].channel_unit});
        index.push_back(g);
      }
    if (names.empty()) continue;
    for (const ChannelLimit& limit : limits_for(*file, names))
      out.push_back({index[limit.channel], limit.term, limit.most, limit.text});
  }
  return out;
}

LimitCount judge_members(std::span<const DeviceRecord> records,
                         const LotGroup& group,
                         const GroupLimit& limit) {
  LimitCount out;
  const DeviceQuantity quantity = quantity_of(limit.term);
  for (std::size_t i = 0; i < group.places.size(); ++i) {
    const LotPlace& place = group.places[i];
    const RecordedChannel& channel = records[place.recording].channels[place.channel];
    const RecordedValue* value = channel.fitted ? channel.find(quantity) : nullptr;
    const Coefficient found = value == nullptr
                                  ? Coefficient{}
                                  : coefficient_of(*value, factor_of(group, channel, quantity));
    const LimitStatus status = judge_limit(found, limit.most);
    const bool same = i > 0 && group.member[i] == group.member[i - 1];
    if (!same) out.status.push_back(status);
    if (rank_of(status) > rank_of(out.status.back())) out.status.back() = status;
    if (status != LimitStatus::fail) continue;
    LimitFailure failure = failure_of(group, found, limit);
    failure.member = group.member[i];
    failure.place = place;
    out.failures.push_back(std::move(failure));
  }
  for (const LimitStatus status : out.status) {
    out.pass += status == LimitStatus::pass;
    out.fail += status == LimitStatus::fail;
    out.not_decided += status == LimitStatus::not_decided;
  }
  return out;
}

}  // namespace libchar
