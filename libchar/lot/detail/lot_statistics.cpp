#include "libchar/lot/detail/lot_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/lot/detail/statistics/grouped_effects.hpp"

namespace libchar {

namespace {

std::vector<std::string> in_natural_order(const std::set<std::string>& words) {
  std::vector<std::string> out(words.begin(), words.end());
  std::sort(out.begin(), out.end(), [](const std::string& a, const std::string& b) { return comes_before(a, b); });
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

namespace {

// The batches of a quantity side by side.
// One-way analysis of variance with known uncertainties: grouped_effects.hpp.

double median_of(std::vector<double> values) {
  if (values.empty()) return kNone;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

// Fills `batches` and `batch_difference` of the quantity; no batches where there is one.
void add_batches(const Fleet& fleet, Statistic& s) {
  QuantityLot& out = s.lot;
  const bool logarithm = in_logarithm(out.quantity);
  std::vector<double> y, v;
  std::vector<std::size_t> batch;
  std::size_t compared = 0;
  for (std::size_t b = 0; b < fleet.batches.size(); ++b) {
    if (s.values.batch_counts[b].members == 0) continue;
    const QuantityValues part = values_of_batch(s.values, *s.group, fleet.batch_of, b);
    const double middle = median_of(part.y);
    BatchLot one{fleet.batches[b], part.counts, std::nullopt, part.counts.counted,
                 logarithm ? std::exp(middle) : middle};
    if (const auto found = effects_of(part, logarithm)) {
      one.figures = lot_figures(found->effects, logarithm);
      one.in_figures = found->effects.count;
    }
    if (enough_count(part.y.size(), part.counts.members)) {
      y.insert(y.end(), part.y.begin(), part.y.end());
      v.insert(v.end(), part.v.begin(), part.v.end());
      batch.insert(batch.end(), part.y.size(), compared++);
    }
    out.batches.push_back(std::move(one));
  }
  if (out.batches.size() < 2) out.batches.clear();
  if (compared < 2) return;
  const GroupedEffects effects = grouped_effects(y, v, batch, compared);
  out.batch_difference =
      BatchDifference{effects.between.spread, effects.between.spread_ci95, effects.within, effects.p};
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

void add_figures(Statistic& s) {
  QuantityLot& lot = s.lot;
  const bool logarithm = in_logarithm(lot.quantity);
  const auto found = effects_of(s.values, logarithm);
  if (!found) return;
  lot.effects = found->effects;
  lot.figures = lot_figures(found->effects, logarithm);
  lot.arithmetic = found->arithmetic;
  lot.of_all = found->of_all;
  if (!lot.of_all) lot.left_out = left_out(lot.quantity, lot.counts, s.values.y, s.values.v, *lot.effects);
}

void add_chart(const Statistic& s, QuantityLot& out) {
  if (s.values.y.size() < kLeastForChart) return;
  out.chart = control_chart(s.values.y);
  for (const std::uint32_t m : s.values.member) out.charted.push_back(place_of(*s.group, m).recording);
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
  const auto limit = std::find_if(fleet.limits.begin(), fleet.limits.end(),
                                  [&](const GroupLimit& l) { return l.group == g && quantity_of(l.term) == quantity; });
  s.limited = limit != fleet.limits.end();
  // Quantization and ramps are looked for where they are suspected only: that they are not there is no news.
  const bool usual = quantity < DeviceQuantity::quantization;
  const bool something = lot.counts.counted > 0 || (usual && lot.counts.not_detected > 0);
  if (!something && !s.limited) return std::nullopt;
  add_figures(s);
  lot.repeats = s.values.repeats;
  lot.temperatures = std::move(s.values.temperatures);
  add_quantiles(s.values.y, logarithm, lot);
  lot.histogram = histogram_of(s.values.y);
  if (fleet.batches.size() > 1) add_batches(fleet, s);
  s.values.squares = {};  // of a hundred thousand devices, many megabytes
  if (!group.of_kind) add_chart(s, lot);
  if (s.limited) {
    s.limit = judge_members(fleet.records, group, *limit);
    add_capability(*limit, s);
  }
  return s;
}

}  // namespace

std::vector<Statistic> statistics_of(const Fleet& fleet) {
  std::vector<std::optional<Statistic>> all(fleet.groups.size() * kDeviceQuantities);
  parallel::for_each(0, all.size(), [&](std::size_t i) {
    all[i] = statistic_of(fleet, i / kDeviceQuantities, static_cast<DeviceQuantity>(i % kDeviceQuantities));
  });
  std::vector<Statistic> out;
  for (auto& one : all)
    if (one) out.push_back(std::move(*one));
  return out;
}

}  // namespace libchar
