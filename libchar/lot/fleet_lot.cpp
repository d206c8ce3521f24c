// Coefficients are compared as logarithms. Means and spreads are those of core/random_effects.hpp: what the records'
// lengths alone make the values scatter is taken out, so that the spread is that of the devices.
#include "libchar/lot/fleet_lot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/lot/detail/lot_statistics.hpp"
#include "libchar/lot/detail/statistics/grouped_effects.hpp"

namespace libchar {
namespace {

// Devices that the others of their group do not let expect.
// Every quantity of every channel is a search of its own (core/random_effects.hpp); with m of them
// each has the share 1/m of the probability of a false alarm (Bonferroni).

FleetOutlier outlier_of(const Fleet& fleet, const Statistic& s, const Outlier& found, double others) {
  const LotPlace place = place_of(*s.group, s.values.member[found.index]);
  const RecordedChannel& channel = fleet.records[place.recording].channels[place.channel];
  FleetOutlier out;
  out.recording = place.recording;
  out.channel = place.channel;
  out.p = found.p;
  out.deviation = found.deviation;
  out.value = s.values.y[found.index];
  const std::string what = channel.name + ": " + title_of(s.lot.quantity);
  if (!in_logarithm(s.lot.quantity)) {
    out.sentence = fmt::format("{} {} {}, {} standard deviations from the others ({}).", what, number_text(out.value),
                               s.lot.unit, number_text(std::abs(found.deviation), 2), probability_text(found.p));
    return out;
  }
  out.ratio = std::exp(out.value - others);
  out.value = std::exp(out.value);
  HabitualValue usual;
  usual.symbol = s.lot.unit;
  if (const auto term = term_of(s.lot.quantity)) usual = detail::headline_unit(*term, s.lot.channel_unit);
  // As its own report has it: the value that is compared is corrected for the bias of a logarithm.
  const RecordedValue* const own = channel.find(s.lot.quantity);
  const double reported = own != nullptr && std::isfinite(own->value)
                              ? own->value * factor_of(*s.group, channel, s.lot.quantity)
                              : out.value;
  out.sentence = fmt::format("{} {} {}, {} times that of the others ({}).", what, number_text(reported * usual.factor),
                             usual.symbol, number_text(out.ratio, 3), probability_text(found.p));
  return out;
}

void add_outliers(const Fleet& fleet, double probability, Statistic& s) {
  std::vector<Outlier> found = find_outliers(s.values.y, s.values.v, probability);
  if (found.empty()) return;
  std::vector<bool> outside(s.values.y.size());
  for (const Outlier& one : found) outside[one.index] = true;
  std::vector<double> y, v;
  for (std::size_t i = 0; i < s.values.y.size(); ++i) {
    if (outside[i]) continue;
    y.push_back(s.values.y[i]);
    v.push_back(s.values.v[i]);
  }
  const double others = random_effects(y, v).mean;
  std::stable_sort(found.begin(), found.end(),
                   [](const Outlier& a, const Outlier& b) { return std::abs(a.deviation) > std::abs(b.deviation); });
  for (const Outlier& one : found) s.lot.outliers.push_back(outlier_of(fleet, s, one, others));
}

/// A quantity of all channels of a kind, device by device: those that count in all of the channels that count in two
/// thirds of them.
struct DeviceTable {
  std::vector<std::string> channels;
  std::vector<std::uint32_t> member;  ///< of the group: the first channel of each device
  std::vector<double> y, v;
};

DeviceTable device_table(const Fleet& fleet, const Statistic& s) {
  const auto name = [&](std::size_t i) -> const std::string& {
    const LotPlace place = place_of(*s.group, s.values.member[i]);
    return fleet.records[place.recording].channels[place.channel].name;
  };
  std::map<std::string, std::size_t> counted;
  std::set<std::uint32_t> devices;
  for (std::size_t i = 0; i < s.values.member.size(); ++i) {
    ++counted[name(i)];
    devices.insert(s.group->devices[s.values.member[i]]);
  }
  DeviceTable out;
  for (const auto& [channel, count] : counted)
    if (enough_count(count, devices.size())) out.channels.push_back(channel);
  for (std::size_t i = 0; i < s.values.member.size();) {
    const std::uint32_t device = s.group->devices[s.values.member[i]], first = s.values.member[i];
    const std::size_t had = out.y.size();
    for (; i < s.values.member.size() && s.group->devices[s.values.member[i]] == device; ++i) {
      if (!std::binary_search(out.channels.begin(), out.channels.end(), name(i))) continue;
      out.y.push_back(s.values.y[i]);
      out.v.push_back(s.values.v[i]);
    }
    const bool whole = out.y.size() - had == out.channels.size();
    if (whole) out.member.push_back(first);
    out.y.resize(whole ? out.y.size() : had);
    out.v.resize(out.y.size());
  }
  return out;
}

/// The device by all of its channels together.
void add_devices(double probability, const DeviceTable& table, Statistic& s) {
  const std::size_t channels = table.channels.size();
  const std::vector<Outlier> found = find_device_outliers(table.y, table.v, channels, probability);
  std::vector<double> mean(table.member.size());
  for (std::size_t i = 0; i < table.y.size(); ++i) mean[i / channels] += table.y[i] / static_cast<double>(channels);
  double others = 0, count = 0;
  for (std::size_t d = 0; d < mean.size(); ++d) {
    const bool out = std::any_of(found.begin(), found.end(), [&](const Outlier& one) { return one.index == d; });
    others += out ? 0 : mean[d];
    count += !out;
  }
  for (const Outlier& one : found) {
    const LotPlace place = place_of(*s.group, table.member[one.index]);
    FleetOutlier& out = s.lot.outliers.emplace_back();
    out.recording = place.recording;
    out.channel = place.channel;
    out.all_channels = true;
    out.p = one.p;
    out.deviation = one.deviation;
    out.value = std::exp(mean[one.index]);
    out.ratio = std::exp(mean[one.index] - others / count);
    out.sentence = fmt::format("{} together: {} {} times that of the others ({}).", first_names(table.channels),
                               title_of(s.lot.quantity), number_text(out.ratio, 3), probability_text(out.p));
  }
}

// Fills `searched` and `outliers` of each quantity. `probability`: of naming any device where none stands out.
void search_outliers(const Fleet& fleet, double probability, std::vector<Statistic>& statistics) {
  std::size_t channels = 0, kinds = 0;
  std::vector<DeviceTable> tables(statistics.size());
  for (std::size_t i = 0; i < statistics.size(); ++i) {
    Statistic& s = statistics[i];
    const LotCounts& counts = s.lot.counts;
    if (shows_outliers(*s.group)) {
      s.lot.searched =
          s.lot.effects && counts.counted >= kFewestForOutliers && enough_count(counts.counted, counts.members);
      channels += s.lot.searched;
      continue;
    }
    tables[i] = device_table(fleet, s);
    s.lot.searched = tables[i].channels.size() > 1 && tables[i].member.size() >= kFewestForOutliers;
    kinds += s.lot.searched;
  }
  // Half to the devices by all of their channels, half to the channels one by one.
  if (channels > 0 && kinds > 0) probability /= 2;
  parallel::for_each(0, statistics.size(), [&](std::size_t i) {
    Statistic& s = statistics[i];
    if (!s.lot.searched) return;
    if (shows_outliers(*s.group))
      add_outliers(fleet, probability / static_cast<double>(channels), s);
    else
      add_devices(probability / static_cast<double>(kinds), tables[i], s);
  });
}

// The devices of a fleet by what is wrong with them.

/// Why a device is among the worst.
struct Reason {
  double p = 1, deviation = 0;
  std::string sentence;
};

using Reasons = std::unordered_map<std::size_t, std::vector<Reason>>;

Reasons reasons_of(const Fleet& fleet, const std::vector<Statistic>& statistics) {
  Reasons out;
  for (const Statistic& s : statistics) {
    for (const FleetOutlier& o : s.lot.outliers)
      out[fleet.sorted.device_of[o.recording]].push_back({o.p, std::abs(o.deviation), o.sentence});
    for (const LimitFailure& f : s.limit.failures)
      out[s.group->devices[f.member]].push_back({f.p, f.deviation, f.sentence});
  }
  return out;
}

bool worse(double p, double deviation, double other_p, double other_deviation) {
  return p != other_p ? p < other_p : deviation > other_deviation;
}

// Those that stand out or fail, the worst first, at most `most`.
void add_worst(const Fleet& fleet, const std::vector<Statistic>& statistics, std::size_t most, FleetLot& out) {
  Reasons reasons = reasons_of(fleet, statistics);
  for (auto& [device, all] : reasons) {
    std::stable_sort(all.begin(), all.end(),
                     [](const Reason& a, const Reason& b) { return worse(a.p, a.deviation, b.p, b.deviation); });
    WorstDevice one{fleet.sorted.first[device], all[0].p, all[0].deviation, {}};
    for (const Reason& reason : all) one.reasons.push_back(reason.sentence);
    out.worst.push_back(std::move(one));
  }
  std::vector<std::size_t> rank(fleet.records.size());
  for (std::size_t i = 0; i < fleet.sorted.order.size(); ++i) rank[fleet.sorted.order[i]] = i;
  std::sort(out.worst.begin(), out.worst.end(), [&](const WorstDevice& a, const WorstDevice& b) {
    if (a.p != b.p || a.deviation != b.deviation) return worse(a.p, a.deviation, b.p, b.deviation);
    return rank[a.recording] < rank[b.recording];
  });
  if (out.worst.size() > most) out.worst.resize(most);
}

// Counts and marks the devices that stand out, fail, keep their limits.
void mark_devices(const Fleet& fleet, const std::vector<Statistic>& statistics, FleetLot& out) {
  std::vector<bool> outlying(out.devices), failing(out.devices), open(out.devices), held(out.devices);
  for (const Statistic& s : statistics) {
    for (const FleetOutlier& o : s.lot.outliers)
      if (!s.lot.of_kind || o.all_channels) outlying[fleet.sorted.device_of[o.recording]] = true;
    for (std::size_t m = 0; m < s.limit.status.size(); ++m) {
      const std::size_t device = s.group->devices[m];
      held[device] = true;
      if (s.limit.status[m] == LimitStatus::fail) failing[device] = true;
      if (s.limit.status[m] == LimitStatus::not_decided) open[device] = true;
    }
  }
  for (std::size_t d = 0; d < out.devices; ++d) {
    out.outlying += outlying[d];
    out.failing += failing[d];
    out.open += !failing[d] && open[d];
    out.keeping += held[d] && !failing[d] && !open[d];
  }
  out.stands_out.resize(fleet.records.size());
  out.fails.resize(fleet.records.size());
  for (std::size_t r = 0; r < fleet.records.size(); ++r) {
    const std::size_t device = fleet.sorted.device_of[r];
    if (device == kNoDevice) continue;
    out.stands_out[r] = outlying[device];
    out.fails[r] = failing[device];
  }
}

// A fleet in a paragraph.

/// Quantities of channels in which batches differ, each with its share of 5 %.
std::string batch_sentence(const FleetLot& lot) {
  const auto tested = [](const QuantityLot& q) { return !q.of_kind && q.batch_difference; };
  const auto tests = std::count_if(lot.quantities.begin(), lot.quantities.end(), tested);
  std::vector<const QuantityLot*> found;
  for (const QuantityLot& q : lot.quantities)
    if (tested(q) && q.batch_difference->p < 0.05 / static_cast<double>(tests)) found.push_back(&q);
  if (tests == 0) return "";
  if (found.empty()) return " No difference between batches is resolved.";
  std::stable_sort(found.begin(), found.end(), [](const QuantityLot* a, const QuantityLot* b) {
    return a->batch_difference->p < b->batch_difference->p;
  });
  constexpr std::size_t kShown = 3;
  std::string list;
  for (std::size_t i = 0; i < std::min(kShown, found.size()); ++i)
    list += fmt::format("{}{} of {}", i == 0 ? "" : ", ", title_of(found[i]->quantity), found[i]->group);
  if (found.size() > kShown) list += fmt::format(" and {} more", found.size() - kShown);
  return fmt::format(" Batches differ: {}.", list);
}

/// ": 1 recording could not be characterized, of 3 recordings the result is not there yet"
std::string without_result(const FleetLot& lot) {
  std::string out;
  if (!lot.failed.empty())
    out += fmt::format(": {} could not be characterized", plural(lot.failed.size(), "recording"));
  if (!lot.awaited.empty())
    out += fmt::format("{} of {} the result is not there yet", out.empty() ? ":" : ",",
                       plural(lot.awaited.size(), "recording"));
  return out;
}

std::string stand_out(const std::vector<std::string>& names, const char* what) {
  return names.size() == 1
             ? fmt::format(" 1 {} is an outlier of its kind: {}.", what, names[0])
             : fmt::format(" {} {}s are outliers of their kind: {}.", names.size(), what, first_names(names));
}

/// That nobody stands out is a finding only where somebody could.
std::string outlying_sentence(const FleetLot& lot, const Fleet& fleet) {
  std::vector<std::string> devices;
  for (const std::size_t r : fleet.sorted.first)
    if (lot.stands_out[r]) devices.push_back(fleet.records[r].device);
  std::set<std::pair<std::size_t, std::size_t>> channels;  // of single devices
  bool any = false, searched = false, axes = true, spoilt = false;
  for (const QuantityLot& q : lot.quantities) {
    any = any || q.counts.counted > 0;
    spoilt = spoilt || q.counts.spoilt > 0;
    searched = searched || q.searched;
    axes = axes && (q.of_kind || !q.searched);
    for (const FleetOutlier& o : q.outliers)
      if (q.of_kind && !o.all_channels) channels.emplace(o.recording, o.channel);
  }
  if (!any) return " There is no result to judge.";
  if (!searched) return fmt::format(" Too few of a kind to find outliers: at least {} are needed.", kFewestForOutliers);
  std::vector<std::string> of_one;
  for (const auto& [recording, channel] : channels) of_one.push_back(fleet.records[recording].channels[channel].name);
  std::string out = devices.empty() ? "" : stand_out(devices, "device");
  if (!of_one.empty()) out += stand_out(of_one, "channel");
  if (!out.empty()) return out;
  return fmt::format(" No {} is an outlier{}.", axes ? "channel" : "device",
                     spoilt ? " among those without a bad finding" : "");
}

/// The alarm of the control charts of all channels together: by the most improbable of their signals, which has the
/// share of one chart and rule.
std::string chart_sentence(const FleetLot& lot) {
  const QuantityLot* worst = nullptr;
  double p = 1;
  std::size_t charts = 0;
  for (const QuantityLot& q : lot.quantities) {
    if (!q.chart) continue;
    ++charts;
    for (const ZoneFinding& found : q.chart->zones.rule)
      if (found.signals > 0 && found.p < p) {
        p = found.p;
        worst = &q;
      }
  }
  const double share = detail::kChartAlarm / static_cast<double>(kZoneRules * std::max<std::size_t>(1, charts));
  if (worst == nullptr || p >= share) return "";
  return fmt::format(" Values change along the lot: {} of {} ({} by chance).", title_of(worst->quantity), worst->group,
                     probability_text(p));
}

std::string fleet_verdict(const FleetLot& lot, const Fleet& fleet) {
  std::string out = plural(lot.devices, "device");
  if (lot.types.size() > 1) out += fmt::format(" of {} types", lot.types.size());
  if (lot.batches.size() > 1) out += fmt::format(" in {} batches", lot.batches.size());
  if (lot.order.size() != lot.devices) out += fmt::format(", {}", plural(lot.order.size(), "recording"));
  out += without_result(lot) + "." + outlying_sentence(lot, fleet);
  const std::size_t held = lot.failing + lot.open + lot.keeping;
  if (held > 0)
    out += fmt::format(" Of {} compared with limits, {} {}, {} not decided, {} all of them.", plural(held, "device"),
                       lot.failing, lot.failing == 1 ? "fails one" : "fail one or more", lot.open,
                       lot.keeping == 1 ? "1 keeps" : fmt::format("{} keep", lot.keeping));
  return out + batch_sentence(lot) + chart_sentence(lot);
}

/// One for each code, with the devices that have it, the worst first.
std::vector<Finding> known_of(std::span<const DeviceRecord> records, std::span<const std::size_t> order) {
  std::map<std::string, std::pair<Finding, std::vector<std::string>>> kinds;
  const auto count = [&](const std::vector<Finding>& findings, const std::string& device) {
    for (const Finding& one : findings) {
      if (one.severity == Severity::note) continue;
      auto& [kind, devices] = kinds.try_emplace(one.code, one, std::vector<std::string>{}).first->second;
      kind.severity = std::max(kind.severity, one.severity);
      if (devices.empty() || devices.back() != device) devices.push_back(device);
    }
  };
  for (const std::size_t r : order) {
    for (const RecordedChannel& channel : records[r].channels) count(channel.findings, records[r].device);
    count(records[r].findings, records[r].device);
  }
  std::vector<Finding> out;
  for (auto& [code, found] : kinds) {
    auto& [kind, devices] = found;
    const FindingKind* row = find_finding_kind(code);
    kind.count = devices.size();
    kind.sentence = fmt::format("{} of {} ({})", row != nullptr ? row->title : std::string_view(code),
                                plural(devices.size(), "device"), first_names(devices));
    kind.phrase = kind.sentence;
    kind.where = {};
    kind.help.clear();
    out.push_back(std::move(kind));
  }
  return worst_first(std::move(out));
}

}  // namespace

FleetLot fleet_lot(std::span<const DeviceRecord> records, const FleetLotOptions& options) {
  if (records.empty())
    throw usage_error("E0752")
        .says("a lot needs at least one device record, there is none")
        .hint("characterize the fleet's logs first");
  const Fleet fleet = fleet_of(records, options);
  FleetLot out;
  out.devices = fleet.sorted.first.size();
  out.order = fleet.sorted.order;
  for (const std::size_t r : out.order)
    if (!records[r].problem.empty()) (records[r].awaited ? out.awaited : out.failed).push_back(r);
  out.types = fleet.types;
  out.batches = fleet.batches;
  out.batch_of.resize(records.size());
  for (const std::size_t r : out.order) out.batch_of[r] = fleet.batch_of[fleet.sorted.device_of[r]];
  std::vector<Statistic> statistics = statistics_of(fleet);
  search_outliers(fleet, options.outlier_probability, statistics);
  mark_devices(fleet, statistics, out);
  add_worst(fleet, statistics, options.worst, out);
  for (Statistic& s : statistics) out.quantities.push_back(std::move(s.lot));
  out.notes = fleet.sorted.notes;
  for (std::string& note : unlike_records(records, fleet.sorted, fleet.groups)) out.notes.push_back(std::move(note));
  out.findings = known_of(records, out.order);
  out.verdict = fleet_verdict(out, fleet);
  return out;
}

}  // namespace libchar
