// Coefficients are compared as logarithms. Means and spreads are those of core/random_effects.hpp: what the records' lengths alone make
// the values scatter is taken out, so that the spread is that of the devices. Every quantity of every channel is a search for outliers of
// its own; with m of them each has the share 1/m of the probability of a false alarm (Bonferroni).
#include "libchar/lot/fleet_lot.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "libchar/core/error.hpp"
#include "libchar/core/pattern.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/lot/detail/lot_groups.hpp"
#include "libchar/lot/detail/lot_limits.hpp"
#include "libchar/lot/detail/quantity_values.hpp"

namespace libchar {
namespace {

using Records = std::span<const DeviceRecord>;

/// A quantity with the values that it is of.
struct Statistic {
  QuantityLot lot;
  const LotGroup* group = nullptr;
  QuantityValues values;
  LimitCount limit;
  bool limited = false;
};

/// What is made once of all records.
struct Fleet {
  Records records;
  SortedRecords sorted;
  std::vector<LotGroup> groups;
  std::vector<std::string> types, batches;
  std::vector<std::size_t> batch_of;  ///< of each device
  std::vector<GroupLimit> limits;
};

std::vector<std::string> in_natural_order(const std::set<std::string>& words) {
  std::vector<std::string> out(words.begin(), words.end());
  std::sort(out.begin(), out.end(), [](const std::string& a, const std::string& b) {
    return comes_before(a, b);
  });
  return out;
}

Fleet fleet_of(Records records, const FleetLotOptions& options) {
  Fleet out;
  out.records = records;
  out.sorted = sorted_records(records);
  out.groups = lot_groups(records, out.sorted);
  std::set<std::string> types, batches;
  for (const std::size_t r : out.sorted.first) {
    types.insert(records[r].type);
    batches.insert(records[r].batch);
  }
  out.types = in_natural_order(types);
  out.batches = in_natural_order(batches);
  std::unordered_map<std::string, std::size_t> index;
  for (std::size_t b = 0; b < out.batches.size(); ++b) index[out.batches[b]] = b;
  for (const std::size_t r : out.sorted.first) out.batch_of.push_back(index[records[r].batch]);
  out.limits = group_limits(out.groups, out.types, options.limits);
  return out;
}

/// A place of a member: its first.
LotPlace place_of(const LotGroup& group, std::uint32_t member) {
  const auto at = std::lower_bound(group.member.begin(), group.member.end(), member);
  return group.places[static_cast<std::size_t>(at - group.member.begin())];
}

void add_quantiles(const std::vector<double>& y, bool logarithm, QuantityLot& out) {
  if (y.empty()) {
    out.quantiles.fill(kNone);
    return;
  }
  std::vector<double> sorted = y;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t q = 0; q < kLotQuantiles.size(); ++q) {
    const double at = kLotQuantiles[q] * static_cast<double>(sorted.size() - 1);
    const auto k = static_cast<std::size_t>(at);
    const double next = sorted[std::min(k + 1, sorted.size() - 1)];
    const double value = sorted[k] + (at - static_cast<double>(k)) * (next - sorted[k]);
    out.quantiles[q] = logarithm ? std::exp(value) : value;
  }
}

/// The values of each batch.
struct BatchValues {
  std::vector<std::vector<double>> y, v;
};

BatchValues by_batch(const Fleet& fleet, const LotGroup& group, const QuantityValues& values) {
  BatchValues out;
  out.y.resize(fleet.batches.size());
  out.v.resize(fleet.batches.size());
  for (std::size_t i = 0; i < values.y.size(); ++i) {
    const std::size_t b = fleet.batch_of[group.devices[values.member[i]]];
    out.y[b].push_back(values.y[i]);
    out.v[b].push_back(values.v[i]);
  }
  return out;
}

void add_batches(const Fleet& fleet, const Statistic& s, QuantityLot& out) {
  const BatchValues parts = by_batch(fleet, *s.group, s.values);
  const bool logarithm = in_logarithm(out.quantity);
  std::vector<double> y, v;
  std::vector<std::size_t> batch;
  std::size_t compared = 0;
  for (std::size_t b = 0; b < fleet.batches.size(); ++b) {
    const LotCounts& counts = s.values.batch_counts[b];
    if (counts.members == 0) continue;
    BatchLot one{fleet.batches[b], counts, std::nullopt, kNone};
    std::vector<double> sorted = parts.y[b];
    std::sort(sorted.begin(), sorted.end());
    if (!sorted.empty()) {
      const std::size_t n = sorted.size();
      const double middle = (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
      one.median = logarithm ? std::exp(middle) : middle;
    }
    if (const auto effects = lot_effects(parts.y[b], parts.v[b], counts.members)) {
      one.figures = lot_figures(*effects, logarithm);
      y.insert(y.end(), parts.y[b].begin(), parts.y[b].end());
      v.insert(v.end(), parts.v[b].begin(), parts.v[b].end());
      batch.insert(batch.end(), parts.y[b].size(), compared++);
    }
    out.batches.push_back(std::move(one));
  }
  if (out.batches.size() < 2) out.batches.clear();
  if (compared < 2) return;
  const GroupedEffects effects = grouped_effects(y, v, batch, compared);
  out.batch_difference = BatchDifference{
      effects.between.spread, effects.between.spread_ci95, effects.within, effects.p};
}

void add_chart(const Statistic& s, QuantityLot& out) {
  if (s.values.y.size() < kLeastForChart) return;
  out.chart = control_chart(s.values.y);
  for (const std::uint32_t m : s.values.member)
    out.charted.push_back(place_of(*s.group, m).recording);
}

void add_capability(const GroupLimit& limit, Statistic& s) {
  Capability c;
  c.most = limit.most;
  c.text = limit.text;
  c.pass = s.limit.pass;
  c.fail = s.limit.fail;
  c.not_decided = s.limit.not_decided;
  if (s.lot.effects) add_ppk(*s.lot.effects, std::log(limit.most), c);
  if (s.lot.effects && s.lot.chart && s.lot.chart->sigma > 0)
    c.cpk = (std::log(limit.most) - s.lot.chart->centre) / (3 * s.lot.chart->sigma);
  s.lot.capability = std::move(c);
}

/// The quantity of a group; nothing where no device has anything of it.
std::optional<Statistic> statistic_of(const Fleet& fleet, std::size_t g, DeviceQuantity quantity) {
  const LotGroup& group = fleet.groups[g];
  const bool logarithm = in_logarithm(quantity);
  if (group.of_kind && !logarithm) return std::nullopt;  // each channel has a bias of its own
  Statistic s;
  s.group = &group;
  s.values = quantity_values(fleet.records, group, quantity, fleet.batch_of, fleet.batches.size());
  QuantityLot& lot = s.lot;
  lot.type = group.type;
  lot.group = group.name;
  lot.of_kind = group.of_kind;
  lot.quantity = quantity;
  lot.channel_unit = group.channel_unit;
  lot.unit = unit_of(quantity, group.channel_unit);
  lot.counts = s.values.counts;
  const auto limit =
      std::find_if(fleet.limits.begin(), fleet.limits.end(), [&](const GroupLimit& l) {
        return l.group == g && quantity_of(l.term) == quantity;
      });
  s.limited = limit != fleet.limits.end();
  // Quantization and ramps are looked for where they are suspected only: that they are not there is no news.
  const bool usual = quantity < DeviceQuantity::quantization;
  const bool something = lot.counts.counted > 0 || (usual && lot.counts.not_detected > 0);
  if (!something && !s.limited) return std::nullopt;
  lot.effects = lot_effects(s.values.y, s.values.v, lot.counts.members);
  if (lot.effects) lot.figures = lot_figures(*lot.effects, logarithm);
  lot.repeats = s.values.repeats;
  add_quantiles(s.values.y, logarithm, lot);
  lot.histogram = histogram_of(s.values.y);
  if (fleet.batches.size() > 1) add_batches(fleet, s, lot);
  if (!group.of_kind) add_chart(s, lot);
  if (s.limited) {
    s.limit = judge_members(fleet.records, group, *limit);
    add_capability(*limit, s);
  }
  return s;
}

std::vector<Statistic> statistics_of(const Fleet& fleet) {
  std::vector<std::optional<Statistic>> all(fleet.groups.size() * kDeviceQuantities);
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    all[i] = statistic_of(
        fleet, i / kDeviceQuantities, static_cast<DeviceQuantity>(i % kDeviceQuantities));
  });
  std::vector<Statistic> out;
  for (auto& one : all)
    if (one) out.push_back(std::move(*one));
  return out;
}

FleetOutlier outlier_of(const Fleet& fleet,
                        const Statistic& s,
                        const Outlier& found,
                        double others) {
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
    out.sentence = fmt::format("{} {} {}, {} standard deviations from the others ({}).",
                               what,
                               number_text(out.value),
                               s.lot.unit,
                               number_text(std::abs(found.deviation), 2),
                               probability_text(found.p));
    return out;
  }
  out.ratio = std::exp(out.value - others);
  out.value = std::exp(out.value);
  out.sentence = fmt::format("{} {} {}, {} times that of the others ({}).",
                             what,
                             number_text(out.value),
                             s.lot.unit,
                             number_text(out.ratio, 3),
                             probability_text(found.p));
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
  std::stable_sort(found.begin(), found.end(), [](const Outlier& a, const Outlier& b) {
    return std::abs(a.deviation) > std::abs(b.deviation);
  });
  for (const Outlier& one : found) s.lot.outliers.push_back(outlier_of(fleet, s, one, others));
}

void search_outliers(const Fleet& fleet, double probability, std::vector<Statistic>& statistics) {
  const auto searched = [](const Statistic& s) { return !s.lot.of_kind && s.lot.effects; };
  const auto count = std::count_if(statistics.begin(), statistics.end(), searched);
  if (count == 0) return;
  tbb::parallel_for(std::size_t{0}, statistics.size(), [&](std::size_t i) {
    if (searched(statistics[i]))
      add_outliers(fleet, probability / static_cast<double>(count), statistics[i]);
  });
}

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

void add_worst(const Fleet& fleet, Reasons reasons, std::size_t most, FleetLot& out) {
  for (auto& [device, all] : reasons) {
    std::stable_sort(all.begin(), all.end(), [](const Reason& a, const Reason& b) {
      return worse(a.p, a.deviation, b.p, b.deviation);
    });
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

void mark_devices(const Fleet& fleet, const std::vector<Statistic>& statistics, FleetLot& out) {
  std::vector<bool> outlying(out.devices), failing(out.devices), open(out.devices),
      held(out.devices);
  for (const Statistic& s : statistics) {
    for (const FleetOutlier& o : s.lot.outliers)
      outlying[fleet.sorted.device_of[o.recording]] = true;
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
    list += fmt::format(
        "{}{} of {}", i == 0 ? "" : ", ", title_of(found[i]->quantity), found[i]->group);
  if (found.size() > kShown) list += fmt::format(" and {} more", found.size() - kShown);
  return fmt::format(" Batches differ: {}.", list);
}

std::string fleet_verdict(const FleetLot& lot) {
  std::string out = plural(lot.devices, "device");
  if (lot.types.size() > 1) out += fmt::format(" of {} types", lot.types.size());
  if (lot.batches.size() > 1) out += fmt::format(" in {} batches", lot.batches.size());
  if (lot.order.size() != lot.devices)
    out += fmt::format(", {}", plural(lot.order.size(), "recording"));
  out += lot.failed.empty() ? "."
                            : fmt::format(": {} could not be characterized.",
                                          plural(lot.failed.size(), "recording"));
  out += lot.outlying == 0   ? " No device stands out from its kind."
         : lot.outlying == 1 ? " 1 device stands out from its kind."
                             : fmt::format(" {} devices stand out from their kind.", lot.outlying);
  const std::size_t held = lot.failing + lot.open + lot.keeping;
  if (held > 0)
    out += fmt::format(" Of {} held against limits, {} {}, {} not decided, {} all of them.",
                       plural(held, "device"),
                       lot.failing,
                       lot.failing == 1 ? "fails one" : "fail one or more",
                       lot.open,
                       lot.keeping == 1 ? "1 keeps" : fmt::format("{} keep", lot.keeping));
  return out + batch_sentence(lot);
}

}  // namespace

FleetLot fleet_lot(Records records, const FleetLotOptions& options) {
  if (records.empty())
    throw Error({ErrorKind::usage,
                 "E0752",
                 "",
                 "a lot needs at least one device record, there is none",
                 "",
                 "characterize the fleet's logs first"});
  const Fleet fleet = fleet_of(records, options);
  FleetLot out;
  out.devices = fleet.sorted.first.size();
  out.order = fleet.sorted.order;
  for (const std::size_t r : out.order)
    if (!records[r].problem.empty()) out.failed.push_back(r);
  out.types = fleet.types;
  out.batches = fleet.batches;
  std::vector<Statistic> statistics = statistics_of(fleet);
  search_outliers(fleet, options.outlier_probability, statistics);
  mark_devices(fleet, statistics, out);
  add_worst(fleet, reasons_of(fleet, statistics), options.worst, out);
  for (Statistic& s : statistics) out.quantities.push_back(std::move(s.lot));
  out.notes = fleet.sorted.notes;
  for (std::string& note : unlike_records(records, fleet.sorted, fleet.groups))
    out.notes.push_back(std::move(note));
  out.verdict = fleet_verdict(out);
  return out;
}

std::string batch_title(const std::string& batch) {
  return batch.empty() ? "no batch" : "batch " + batch;
}

}  // namespace libchar
