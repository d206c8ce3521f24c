// Means: Welch's t (Biometrika 34 (1947) 28) of the random-effects means, whose standard errors are Hartung and Knapp's
// (core/random_effects.hpp). Spreads: detail/equal_spread.cpp. All tests together: Holm (Scand. J. Stat. 6 (1979) 65): the i-th smallest of
// m probabilities times m - i + 1, never less than the one before.
#include "libchar/lot/lot_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "libchar/core/distributions.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/lot/detail/equal_spread.hpp"
#include "libchar/lot/detail/lot_groups.hpp"
#include "libchar/lot/detail/quantity_values.hpp"

namespace libchar {
namespace {

using Records = std::span<const DeviceRecord>;
using GroupKey =
    std::tuple<std::string, std::string, std::string>;  // type, channel, what it measures

struct Side {
  Records records;
  SortedRecords sorted;
  std::vector<LotGroup> groups;
  std::map<GroupKey, std::size_t> index;  ///< of the groups that are channels
  std::vector<std::size_t> one_batch;     ///< batches are not looked at here
};

Side side_of(Records records, const std::string& name) {
  if (records.empty())
    throw Error({ErrorKind::usage,
                 "E0752",
                 "",
                 "a lot needs at least one device record, there is none in " + name,
                 "",
                 "characterize its logs first"});
  Side out{records, sorted_records(records), {}, {}, {}};
  out.groups = lot_groups(records, out.sorted);
  out.one_batch.resize(out.sorted.first.size());
  for (std::size_t g = 0; g < out.groups.size(); ++g)
    if (!out.groups[g].of_kind)
      out.index[{out.groups[g].type, out.groups[g].name, out.groups[g].measures}] = g;
  return out;
}

QuantityValues values_of(const Side& side, std::size_t g, DeviceQuantity quantity) {
  return quantity_values(side.records, side.groups[g], quantity, side.one_batch, 1);
}

double standard_error(const RandomEffects& effects) {
  const double dof = static_cast<double>(effects.count) - 1;
  return (effects.mean_ci95.high - effects.mean_ci95.low) / 2 / student_quantile(0.975, dof);
}

void compare_means(const RandomEffects& a,
                   const RandomEffects& b,
                   bool logarithm,
                   LotDifference& out) {
  const double va = std::pow(standard_error(a), 2), vb = std::pow(standard_error(b), 2);
  out.change = logarithm ? std::exp(b.mean - a.mean) : b.mean - a.mean;
  if (!std::isfinite(va + vb)) {  // a mean that has no end differs from nothing
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    out.p_mean = 1;
    out.change_ci95 = {logarithm ? 0 : -kInfinity, kInfinity};
    return;
  }
  const double dof =
      (va + vb) * (va + vb) /
      (va * va / (static_cast<double>(a.count) - 1) + vb * vb / (static_cast<double>(b.count) - 1));
  const double sd = std::sqrt(va + vb), difference = b.mean - a.mean;
  const double half = student_quantile(0.975, dof) * sd;
  out.p_mean = 2 * student_tail(std::abs(difference) / sd, dof);
  out.change_ci95 = {difference - half, difference + half};
  if (logarithm) out.change_ci95 = {std::exp(difference - half), std::exp(difference + half)};
}

/// Nothing where one of the lots has no mean of it.
std::optional<LotDifference> difference_of(
    const Side& a, std::size_t ga, const Side& b, std::size_t gb, DeviceQuantity quantity) {
  const QuantityValues va = values_of(a, ga, quantity), vb = values_of(b, gb, quantity);
  const bool logarithm = in_logarithm(quantity);
  const auto ea = effects_of(va, logarithm), eb = effects_of(vb, logarithm);
  if (!ea || !eb) return std::nullopt;
  const LotGroup& group = a.groups[ga];
  LotDifference out;
  out.type = group.type;
  out.group = group.name;
  out.quantity = quantity;
  out.channel_unit = group.channel_unit;
  out.unit = unit_of(quantity, group.channel_unit);
  out.counts_a = va.counts;
  out.counts_b = vb.counts;
  out.a = lot_figures(ea->effects, logarithm);
  out.b = lot_figures(eb->effects, logarithm);
  compare_means(ea->effects, eb->effects, logarithm, out);
  out.p_spread = equal_spread_p(va.y, va.v, vb.y, vb.v);
  return out;
}

/// "2 of 20 devices of march": of all that have the channel, whatever the quantity is found of.
std::string known_text(const QuantityValues& values,
                       const LotGroup& group,
                       const std::string& name) {
  return fmt::format("{} of {} devices of {}", values.counts.counted, group.devices.size(), name);
}

/// Counted in one and hardly in the other: no means to compare, which is a difference in itself.
void note_detection(const Side& a,
                    std::size_t ga,
                    const Side& b,
                    std::size_t gb,
                    DeviceQuantity quantity,
                    FleetComparison& out) {
  const QuantityValues va = values_of(a, ga, quantity), vb = values_of(b, gb, quantity);
  if (va.counts.counted + vb.counts.counted == 0) return;
  const bool logarithm = in_logarithm(quantity);
  const bool in_a = effects_of(va, logarithm).has_value(),
             in_b = effects_of(vb, logarithm).has_value();
  const bool only_a = !in_a && in_b, only_b = in_a && !in_b;
  out.not_compared.push_back(fmt::format("{} of {}: known of {} and of {}: too few{} for means.",
                                         title_of(quantity),
                                         channel_title(a.groups[ga].name, a.groups[ga].type),
                                         known_text(va, a.groups[ga], out.name_a),
                                         known_text(vb, b.groups[gb], out.name_b),
                                         only_a   ? " of " + out.name_a
                                         : only_b ? " of " + out.name_b
                                                  : ""));
}

void note_only(const Side& here, const Side& there, const std::string& name, FleetComparison& out) {
  for (const auto& [key, g] : here.index)
    if (there.index.count(key) == 0)
      out.not_compared.push_back(fmt::format("{} in {}: only in {}.",
                                             channel_title(std::get<1>(key), std::get<0>(key)),
                                             unit_title(here.groups[g].channel_unit),
                                             name));
}

void correct_for_all(FleetComparison& out) {
  std::vector<std::pair<double, double*>> all;
  for (LotDifference& d : out.differences) {
    all.emplace_back(d.p_mean, &d.p_mean_of_all);
    all.emplace_back(d.p_spread, &d.p_spread_of_all);
  }
  std::stable_sort(
      all.begin(), all.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  out.tests = all.size();
  double before = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    before = std::min(1.0, std::max(before, static_cast<double>(all.size() - i) * all[i].first));
    *all[i].second = before;
  }
  for (LotDifference& d : out.differences) {
    d.mean_differs = d.p_mean_of_all < out.false_alarm;
    d.spread_differs = d.p_spread_of_all < out.false_alarm;
  }
}

std::string percent(double ratio) {
  return number_text(100 * (ratio - 1), 3);
}

std::string mean_phrase(const LotDifference& d, const FleetComparison& c) {
  if (!in_logarithm(d.quantity))
    return fmt::format("{} of {} is {} {} {} than of {} [{}, {}], {}",
                       title_of(d.quantity),
                       c.name_b,
                       number_text(std::abs(d.change)),
                       d.unit,
                       d.change < 0 ? "lower" : "higher",
                       c.name_a,
                       number_text(d.change_ci95.low),
                       number_text(d.change_ci95.high),
                       probability_text(d.p_mean_of_all));
  // From 2 on, and from a half down, a factor says it better than per cent.
  const bool factor = d.change >= 2 || d.change <= 0.5;
  if (factor)
    return fmt::format("{} of {} is {} times that of {} [{}, {}], {}",
                       title_of(d.quantity),
                       c.name_b,
                       number_text(d.change, 3),
                       c.name_a,
                       number_text(d.change_ci95.low, 3),
                       number_text(d.change_ci95.high, 3),
                       probability_text(d.p_mean_of_all));
  return fmt::format("{} of {} is {} % {} than of {} [{}, {}], {}",
                     title_of(d.quantity),
                     c.name_b,
                     number_text(std::abs(100 * (d.change - 1)), 3),
                     d.change < 1 ? "smaller" : "larger",
                     c.name_a,
                     percent(d.change_ci95.low),
                     percent(d.change_ci95.high),
                     probability_text(d.p_mean_of_all));
}

std::string spread_text(const LotDifference& d, const LotFigures& f) {
  return in_logarithm(d.quantity) ? number_text(100 * f.spread, 3) + " %"
                                  : number_text(f.spread, 3) + " " + d.unit;
}

std::string sentence_of(const LotDifference& d, const FleetComparison& c) {
  std::string out = channel_title(d.group, d.type) + ": ";
  if (d.mean_differs) out += mean_phrase(d, c);
  if (d.spread_differs)
    out += fmt::format("{}devices of {} scatter by {}, those of {} by {}, {}",
                       d.mean_differs ? "; " : title_of(d.quantity) + ": ",
                       c.name_b,
                       spread_text(d, d.b),
                       c.name_a,
                       spread_text(d, d.a),
                       probability_text(d.p_spread_of_all));
  if (!d.mean_differs && !d.spread_differs)
    out += title_of(d.quantity) + ": no difference is resolved";
  return out + ".";
}

std::string comparison_verdict(const FleetComparison& c) {
  const auto differs = std::count_if(c.differences.begin(), c.differences.end(), [](const auto& d) {
    return d.mean_differs || d.spread_differs;
  });
  const std::string what = fmt::format("{} of {} and {} of {}, {}",
                                       plural(c.devices_a, "device"),
                                       c.name_a,
                                       plural(c.devices_b, "device"),
                                       c.name_b,
                                       plural(c.tests, "test"));
  const std::string chance =
      fmt::format(" Lots that are alike give any difference in {} % of comparisons.",
                  number_text(100 * c.false_alarm, 2));
  if (differs == 0) return what + ": no difference is resolved." + chance;
  return fmt::format("{}: {} of {} quantities differ{}.{}",
                     what,
                     differs,
                     c.differences.size(),
                     differs == 1 ? "s" : "",
                     chance);
}

}  // namespace

FleetComparison compare_lots(Records a, Records b, const CompareLotsOptions& options) {
  const Side sa = side_of(a, options.name_a);
  Side sb = side_of(b, options.name_b);
  FleetComparison out;
  out.name_a = options.name_a;
  out.name_b = options.name_b;
  out.false_alarm = options.false_alarm;
  out.devices_a = sa.sorted.first.size();
  out.devices_b = sb.sorted.first.size();
  bool common = false;
  for (std::size_t ga = 0; ga < sa.groups.size(); ++ga) {
    const LotGroup& group = sa.groups[ga];
    const auto other = sb.index.find({group.type, group.name, group.measures});
    if (group.of_kind || other == sb.index.end()) continue;
    common = true;
    if (LotGroup& in_b = sb.groups[other->second]; in_b.channel_unit != group.channel_unit) {
      out.notes.push_back(fmt::format("{} is in {} in {} and in {} in {}: compared in {}.",
                                      channel_title(group.name, group.type),
                                      group.channel_unit,
                                      options.name_a,
                                      in_b.channel_unit,
                                      options.name_b,
                                      group.channel_unit));
      convert_group(group.channel_unit, in_b);
    }
    for (const auto& row : enum_table<DeviceQuantity>) {
      if (auto d = difference_of(sa, ga, sb, other->second, row.value))
        out.differences.push_back(std::move(*d));
      else
        note_detection(sa, ga, sb, other->second, row.value, out);
    }
  }
  if (!common)
    throw Error(
        {ErrorKind::input,
         "E0753",
         "",
         fmt::format("{} and {} have no channel of one type, name and kind of unit in common",
                     options.name_a,
                     options.name_b),
         "",
         "compare lots of one type of device"});
  note_only(sa, sb, options.name_a, out);
  note_only(sb, sa, options.name_b, out);
  correct_for_all(out);
  for (LotDifference& d : out.differences) d.sentence = sentence_of(d, out);
  out.verdict = comparison_verdict(out);
  return out;
}

}  // namespace libchar
