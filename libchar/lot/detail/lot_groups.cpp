#include "libchar/lot/detail/lot_groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

namespace {

const NoiseLimits* limits_of(const std::string& type, const std::map<std::string, NoiseLimits>& limits) {
  auto at = limits.find(type);
  if (at == limits.end()) at = limits.find("");
  return at == limits.end() ? nullptr : &at->second;
}

void check_types(const std::vector<std::string>& types, const std::map<std::string, NoiseLimits>& limits) {
  for (const auto& [type, file] : limits)
    if (!type.empty() && std::find(types.begin(), types.end(), type) == types.end())
      throw usage_error("E0751", file.file)
          .says("limits of a type that no device of the fleet is of")
          .got(type)
          .hint("the types are {}", fmt::join(types, ", "));
}

/// How bad the news is: of several recordings the worst counts.
int rank_of(LimitStatus status) { return status == LimitStatus::fail ? 2 : status == LimitStatus::not_decided ? 1 : 0; }

LimitFailure failure_of(const LotGroup& group, const Coefficient& found, const GroupLimit& limit) {
  LimitFailure out;
  const double value = found.value.value_or(limit.most);
  // Without a standard deviation the interval, which lies above the limit, says it.
  const double sd = found.relative_sd > 0 ? found.relative_sd : std::log(value / found.ci95.low) / kNormal95;
  out.deviation = std::log(value / limit.most) / std::max(sd, 1e-9);
  out.p = std::erfc(out.deviation / std::sqrt(2.0)) / 2;
  const DeviceQuantity quantity = quantity_of(limit.term);
  const std::string unit = unit_of(quantity, group.channel_unit);
  out.sentence = fmt::format("{}: {} {} {}, allowed {}.", group.name, title_of(quantity), coefficient_text(found), unit,
                             limit_text(limit.text, limit.most, unit));
  return out;
}

}  // namespace

std::vector<GroupLimit> group_limits(const std::vector<LotGroup>& groups, const std::vector<std::string>& types,
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

LimitCount judge_members(std::span<const DeviceRecord> records, const LotGroup& group, const GroupLimit& limit) {
  LimitCount out;
  const DeviceQuantity quantity = quantity_of(limit.term);
  for (std::size_t i = 0; i < group.places.size(); ++i) {
    const LotPlace& place = group.places[i];
    const RecordedChannel& channel = records[place.recording].channels[place.channel];
    const RecordedValue* value = channel.fitted ? channel.find(quantity) : nullptr;
    const Coefficient found =
        value == nullptr ? Coefficient{} : coefficient_of(*value, factor_of(group, channel, quantity));
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

namespace {

using Records = std::span<const DeviceRecord>;

/// -1, 0, 1 in natural order.
int compared(const std::string& a, const std::string& b) {
  if (a == b) return 0;
  return comes_before(a, b) ? -1 : 1;
}

bool stands_before(const DeviceRecord& a, const std::string& batch_a, const DeviceRecord& b,
                   const std::string& batch_b) {
  if (const int way = compared(a.type, b.type); way != 0) return way < 0;
  if (const int way = compared(batch_a, batch_b); way != 0) return way < 0;
  for (const auto member : {&DeviceRecord::device, &DeviceRecord::batch, &DeviceRecord::log, &DeviceRecord::sha256,
                            &DeviceRecord::settings})
    if (const int way = compared(a.*member, b.*member); way != 0) return way < 0;
  return false;
}

/// A unit as it is written. Without a unit nobody knows what two channels have in common: no kind.
struct KnownUnit {
  std::string symbol, measures;
  double to_si = 1;
};

KnownUnit known_unit(const std::string& text) {
  const auto unit = find_unit(text);
  if (!unit) return {text, text.empty() ? "" : "in " + text, 1};
  // Scales of temperature have a zero of their own: a mean is not converted by a factor.
  if (unit->quantity == Quantity::temperature) return {unit->symbol, "in " + unit->symbol, unit->to_si};
  return {unit->symbol, std::string(name_of(unit->quantity)), unit->to_si};
}

/// "angular_rate in deg/s", "in counts"
std::string kind_name(const std::string& symbol) {
  const auto unit = find_unit(symbol);
  return unit ? fmt::format("{} in {}", name_of(unit->quantity), symbol) : "in " + symbol;
}

/// The unit of most recordings; of as many, the first by its spelling.
void choose_unit(Records records, LotGroup& group) {
  std::map<std::string, std::size_t> count;
  for (const LotPlace& p : group.places) ++count[records[p.recording].channels[p.channel].unit];
  std::map<std::string, std::size_t> symbols;
  for (const auto& [text, n] : count) symbols[known_unit(text).symbol] += n;
  const auto most = std::max_element(symbols.begin(), symbols.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  group.channel_unit = most->first;
  const double to_si = known_unit(most->first).to_si;
  for (const auto& [text, n] : count) group.factor[text] = known_unit(text).to_si / to_si;
  if (group.of_kind) group.name = kind_name(group.channel_unit);
}

/// Each device's channels of a group, in order of devices: the recordings of one stand together.
void number_members(Records records, const std::vector<std::size_t>& device_of, LotGroup& group) {
  const auto key = [&](const LotPlace& p) {
    return std::tuple<std::size_t, std::string_view, std::uint32_t>(
        device_of[p.recording], records[p.recording].channels[p.channel].name, p.recording);
  };
  // Recordings of one device keep their order.
  std::stable_sort(group.places.begin(), group.places.end(), [&](const LotPlace& a, const LotPlace& b) {
    const auto ka = key(a), kb = key(b);
    return std::tie(std::get<0>(ka), std::get<1>(ka)) < std::tie(std::get<0>(kb), std::get<1>(kb));
  });
  for (std::size_t i = 0; i < group.places.size(); ++i) {
    const auto here = key(group.places[i]);
    if (i > 0) {
      const auto before = key(group.places[i - 1]);
      if (std::get<0>(here) == std::get<0>(before) && std::get<1>(here) == std::get<1>(before)) {
        group.member.push_back(group.member.back());
        continue;
      }
    }
    group.member.push_back(static_cast<std::uint32_t>(group.devices.size()));
    group.devices.push_back(static_cast<std::uint32_t>(std::get<0>(here)));
  }
}

/// Groups by type, then a name, found again by a text.
class GroupTable {
 public:
  explicit GroupTable(bool of_kind) : of_kind_(of_kind) {}
  LotGroup& of(const std::string& type, const std::string& name, const std::string& measures) {
    key_.assign(type).append(1, '\0').append(name).append(1, '\0').append(measures);
    const auto [at, fresh] = index_.try_emplace(key_, groups_.size());
    if (fresh) {
      LotGroup& group = groups_.emplace_back();
      group.type = type;
      group.name = name;
      group.measures = measures;
      group.of_kind = of_kind_;
    }
    return groups_[at->second];
  }
  std::vector<LotGroup> take() { return std::move(groups_); }

 private:
  bool of_kind_;
  std::string key_;
  std::unordered_map<std::string, std::size_t> index_;
  std::vector<LotGroup> groups_;
};

/// " (A01, A02, A03 and 9 more)"
std::string named_devices(Records records, const SortedRecords& sorted, const LotGroup& group) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names;
  for (std::size_t m = 0; m < std::min(kNamed, group.devices.size()); ++m)
    names.push_back(records[sorted.first[group.devices[m]]].device);
  return fmt::format(" ({}{})", fmt::join(names, ", "),
                     group.devices.size() > kNamed ? fmt::format(" and {} more", group.devices.size() - kNamed) : "");
}

bool several_names(Records records, const LotGroup& kind) {
  const auto name = [&](const LotPlace& p) -> const std::string& {
    return records[p.recording].channels[p.channel].name;
  };
  return std::any_of(kind.places.begin(), kind.places.end(),
                     [&](const LotPlace& p) { return name(p) != name(kind.places[0]); });
}

/// "gx, gy: recorded in deg/s, rad/s, compared in deg/s."
std::vector<std::string> converted_units(const std::vector<LotGroup>& groups) {
  std::map<std::string, std::vector<std::string>> channels;
  for (const LotGroup& group : groups) {
    std::set<std::string> symbols;
    for (const auto& [text, factor] : group.factor) symbols.insert(known_unit(text).symbol);
    if (group.of_kind || symbols.size() < 2) continue;
    channels[fmt::format("recorded in {}, compared in {}", fmt::join(symbols, ", "), group.channel_unit)].push_back(
        channel_title(group.name, group.type));
  }
  std::vector<std::string> out;
  for (const auto& [how, names] : channels) out.push_back(fmt::format("{}: {}.", fmt::join(names, ", "), how));
  return out;
}

/// The same log of the same device twice: a run that was begun again writes it again.
std::string copies_note(std::size_t copies) {
  return fmt::format("{} of a log that is there already, with the same settings: not counted twice.",
                     plural(copies, "record"));
}

}  // namespace

std::string unit_title(const std::string& channel_unit) { return channel_unit.empty() ? "no unit" : channel_unit; }

std::string channel_title(const std::string& channel, const std::string& type) {
  return type.empty() ? channel : channel + " of " + type;
}

SortedRecords sorted_records(Records records) {
  SortedRecords out;
  const DeviceBatches found = device_batches(records);
  const auto batch = [&](std::size_t r) -> const std::string& { return found.batch[found.device_of[r]]; };
  out.order.resize(records.size());
  std::iota(out.order.begin(), out.order.end(), std::size_t{0});
  std::stable_sort(out.order.begin(), out.order.end(), [&](std::size_t a, std::size_t b) {
    return stands_before(records[a], batch(a), records[b], batch(b));
  });
  out.device_of.assign(records.size(), kNoDevice);
  std::vector<std::size_t> number(found.batch.size(), kNoDevice);
  std::set<std::tuple<std::size_t, std::string, std::string>> logs;
  std::vector<std::size_t> kept;
  for (const std::size_t r : out.order) {
    const DeviceRecord& one = records[r];
    std::size_t& device = number[found.device_of[r]];
    if (device == kNoDevice) {
      device = out.first.size();
      out.first.push_back(r);
      out.batch.push_back(batch(r));
    }
    if (!one.sha256.empty() && !logs.emplace(device, one.sha256, one.settings).second) continue;
    out.device_of[r] = device;
    kept.push_back(r);
  }
  if (!found.note.empty()) out.notes.push_back(found.note);
  if (kept.size() < out.order.size()) out.notes.push_back(copies_note(out.order.size() - kept.size()));
  out.order = std::move(kept);
  return out;
}

std::vector<LotGroup> lot_groups(Records records, const SortedRecords& sorted) {
  GroupTable names(false), kinds(true);
  std::unordered_map<std::string, KnownUnit> units;
  for (const std::size_t r : sorted.order)
    for (std::size_t c = 0; c < records[r].channels.size(); ++c) {
      const RecordedChannel& channel = records[r].channels[c];
      auto unit = units.find(channel.unit);
      if (unit == units.end()) unit = units.emplace(channel.unit, known_unit(channel.unit)).first;
      const LotPlace place{static_cast<std::uint32_t>(r), static_cast<std::uint32_t>(c)};
      const std::string& measures = unit->second.measures;
      names.of(records[r].type, channel.name, measures).places.push_back(place);
      if (!channel.unit.empty()) kinds.of(records[r].type, "", measures).places.push_back(place);
    }
  std::vector<LotGroup> out;
  for (LotGroup& kind : kinds.take())
    if (several_names(records, kind)) out.push_back(std::move(kind));
  for (LotGroup& name : names.take()) out.push_back(std::move(name));
  std::stable_sort(out.begin(), out.end(), [](const LotGroup& a, const LotGroup& b) {
    return a.of_kind != b.of_kind ? a.of_kind : compared(a.type, b.type) < 0;
  });
  for (LotGroup& group : out) {
    choose_unit(records, group);
    number_members(records, sorted.device_of, group);
  }
  return out;
}

bool shows_outliers(const LotGroup& group) { return !group.of_kind || group.devices.front() == group.devices.back(); }

double factor_of(const LotGroup& group, const RecordedChannel& channel, DeviceQuantity quantity) {
  if (quantity == DeviceQuantity::gauss_markov_time) return 1;
  return group.factor.size() == 1 ? group.factor.begin()->second : group.factor.at(channel.unit);
}

void convert_group(const std::string& channel_unit, LotGroup& group) {
  const double by = known_unit(group.channel_unit).to_si / known_unit(channel_unit).to_si;
  for (auto& [text, factor] : group.factor) factor *= by;
  group.channel_unit = channel_unit;
}

std::vector<std::string> unlike_records(Records records, const SortedRecords& sorted,
                                        const std::vector<LotGroup>& groups) {
  std::vector<std::string> out = converted_units(groups);
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::string>> units;
  for (const LotGroup& group : groups)
    if (!group.of_kind)
      units[{group.type, group.name}][group.channel_unit] =
          unit_title(group.channel_unit) + named_devices(records, sorted, group);
  for (const auto& [channel, found] : units) {
    if (found.size() < 2) continue;
    std::vector<std::string> each;
    for (const auto& [unit, text] : found) each.push_back(text);
    out.push_back(fmt::format("{} has {} units, {}: compared within each.",
                              channel_title(channel.second, channel.first), found.size(), fmt::join(each, ", ")));
  }
  std::set<std::string> settings, programs;
  for (const std::size_t r : sorted.order) {
    if (!records[r].problem.empty()) continue;  // characterized with none
    settings.insert(records[r].analysis.empty() ? records[r].settings : records[r].analysis);
    programs.insert(records[r].program);
  }
  for (const auto& [what, found] : {std::pair("settings", &settings), std::pair("versions of the program", &programs)})
    if (found->size() > 1)
      out.push_back(
          fmt::format("The recordings were characterized with {} {}: what differs may be that.", found->size(), what));
  return out;
}

}  // namespace libchar
