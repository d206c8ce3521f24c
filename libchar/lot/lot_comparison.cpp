// Means: Welch's t (Biometrika 34 (1947) 28) of the random-effects means, whose standard errors are Hartung and Knapp's
// (core/random_effects.hpp). Spreads: detail/equal_spread.cpp. All tests together: Holm (Scand. J. Stat. 6 (1979) 65):
// the i-th smallest of m probabilities times m - i + 1, never less than the one before.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/lot/detail/lot_figures.hpp"
#include "libchar/lot/detail/lot_statistics.hpp"
#include "libchar/lot/detail/statistics/grouped_effects.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {
namespace {

// Do two lots scatter alike?
// With the spread s that both have in common (detail/grouped_effects.hpp) and z = (y - mean of its lot) / sqrt(v + s²),
// the ratio of the mean squares of z in the two lots is Fisher's F, exactly where either the uncertainties or the
// spread are nothing. F believes that the values are normal: with the kurtosis g of all z, at least 3, lots of n values
// have 2 n / (g - (n - 3)/(n - 1)) degrees of freedom, n - 1 for g = 3 (Shoemaker, Am. Stat. 57 (2003) 105).

constexpr std::size_t kLeast = 4;

struct Powers {
  double n = 0, second = 0, fourth = 0;  ///< sums of z² and z⁴
};

Powers powers_of(std::span<const double> y, std::span<const double> v, double mean, double square) {
  Powers out;
  out.n = static_cast<double>(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double z2 = (y[i] - mean) * (y[i] - mean) / (v[i] + square);
    out.second += z2;
    out.fourth += z2 * z2;
  }
  return out;
}

double degrees_of_freedom(double n, double kurtosis) { return 2 * n / (kurtosis - (n - 3) / (n - 1)); }

// Probability of spreads that differ as much where they are equal; 1 of fewer than four values on a side.
double equal_spread_p(std::span<const double> y_a, std::span<const double> v_a, std::span<const double> y_b,
                      std::span<const double> v_b) {
  if (std::min(y_a.size(), y_b.size()) < kLeast) return 1;
  std::vector<double> y(y_a.begin(), y_a.end()), v(v_a.begin(), v_a.end());
  y.insert(y.end(), y_b.begin(), y_b.end());
  v.insert(v.end(), v_b.begin(), v_b.end());
  std::vector<std::size_t> lot(y.size());
  std::fill(lot.begin() + static_cast<std::ptrdiff_t>(y_a.size()), lot.end(), std::size_t{1});
  const GroupedEffects both = grouped_effects(y, v, lot, 2);
  const double square = both.within * both.within;
  const Powers a = powers_of(y_a, v_a, both.mean[0], square), b = powers_of(y_b, v_b, both.mean[1], square);
  const double sum = a.second + b.second;
  if (!(a.second > 0) || !(b.second > 0)) return 1;
  const double kurtosis = std::max(3.0, (a.n + b.n) * (a.fourth + b.fourth) / (sum * sum));
  const double f = b.second / (b.n - 1) / (a.second / (a.n - 1));
  const double dof_a = degrees_of_freedom(a.n, kurtosis), dof_b = degrees_of_freedom(b.n, kurtosis);
  return std::min(1.0, 2 * std::min(fisher_cdf(f, dof_b, dof_a), fisher_tail(f, dof_b, dof_a)));
}

using Records = std::span<const DeviceRecord>;

Fleet side_of(Records records, const std::string& name) {
  if (records.empty())
    throw usage_error("E0752")
        .says("a lot needs at least one device record, there is none in " + name)
        .hint("characterize its logs first");
  return fleet_of(records, {});
}

/// The same channel of another lot; null: it has none.
LotGroup* same_channel(Fleet& side, const LotGroup& channel) {
  for (LotGroup& group : side.groups)
    if (!group.of_kind && group.type == channel.type && group.name == channel.name &&
        group.measures == channel.measures)
      return &group;
  return nullptr;
}

/// A quantity of a channel in one of the lots.
struct SideValues {
  QuantityValues values;
  std::optional<QuantityEffects> effects;  ///< none: too few for a mean
};

SideValues values_of(const Fleet& side, const LotGroup& group, DeviceQuantity quantity) {
  SideValues out{quantity_values(side.records, group, quantity, side.batch_of, side.batches.size()), {}};
  out.effects = effects_of(out.values, in_logarithm(quantity));
  return out;
}

double standard_error(const RandomEffects& effects) {
  const double dof = static_cast<double>(effects.count) - 1;
  return (effects.mean_ci95.high - effects.mean_ci95.low) / 2 / student_quantile(0.975, dof);
}

void compare_means(const RandomEffects& a, const RandomEffects& b, bool logarithm, LotDifference& out) {
  const double va = std::pow(standard_error(a), 2), vb = std::pow(standard_error(b), 2);
  out.change = logarithm ? std::exp(b.mean - a.mean) : b.mean - a.mean;
  if (!std::isfinite(va + vb)) {  // a mean that has no end differs from nothing
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    out.p_mean = 1;
    out.change_ci95 = {logarithm ? 0 : -kInfinity, kInfinity};
    return;
  }
  const double dof = (va + vb) * (va + vb) /
                     (va * va / (static_cast<double>(a.count) - 1) + vb * vb / (static_cast<double>(b.count) - 1));
  const double sd = std::sqrt(va + vb), difference = b.mean - a.mean;
  const double half = student_quantile(0.975, dof) * sd;
  out.p_mean = 2 * student_tail(std::abs(difference) / sd, dof);
  out.change_ci95 = {difference - half, difference + half};
  if (logarithm) out.change_ci95 = {std::exp(difference - half), std::exp(difference + half)};
}

/// Both lots have a mean of it.
LotDifference difference_of(const LotGroup& group, const SideValues& a, const SideValues& b, DeviceQuantity quantity) {
  const bool logarithm = in_logarithm(quantity);
  LotDifference out;
  out.type = group.type;
  out.group = group.name;
  out.quantity = quantity;
  out.channel_unit = group.channel_unit;
  out.unit = unit_of(quantity, group.channel_unit);
  out.counts_a = a.values.counts;
  out.counts_b = b.values.counts;
  out.a = lot_figures(a.effects->effects, logarithm);
  out.b = lot_figures(b.effects->effects, logarithm);
  compare_means(a.effects->effects, b.effects->effects, logarithm, out);
  out.p_spread = equal_spread_p(a.values.y, a.values.v, b.values.y, b.values.v);
  return out;
}

/// "2 of 20 devices of march": of all that have the channel, whatever the quantity is found of.
std::string known_text(const QuantityValues& values, const LotGroup& group, const std::string& name) {
  return fmt::format("{} of {} devices of {}", values.counts.counted, group.devices.size(), name);
}

/// Counted in one and hardly in the other: no means to compare, which is a difference in itself.
void note_detection(const LotGroup& group, const SideValues& a, const LotGroup& group_b, const SideValues& b,
                    DeviceQuantity quantity, FleetComparison& out) {
  if (a.values.counts.counted + b.values.counts.counted == 0) return;
  const bool only_a = !a.effects && b.effects, only_b = a.effects && !b.effects;
  out.not_compared.push_back(fmt::format("{} of {}: known of {} and of {}: too few{} for means.", title_of(quantity),
                                         channel_title(group.name, group.type), known_text(a.values, group, out.name_a),
                                         known_text(b.values, group_b, out.name_b),
                                         only_a   ? " of " + out.name_a
                                         : only_b ? " of " + out.name_b
                                                  : ""));
}

void note_only(const Fleet& here, Fleet& there, const std::string& name, FleetComparison& out) {
  for (const LotGroup& group : here.groups)
    if (!group.of_kind && same_channel(there, group) == nullptr)
      out.not_compared.push_back(fmt::format("{} in {}: only in {}.", channel_title(group.name, group.type),
                                             unit_title(group.channel_unit), name));
}

void correct_for_all(FleetComparison& out) {
  std::vector<std::pair<double, double*>> all;
  for (LotDifference& d : out.differences) {
    all.emplace_back(d.p_mean, &d.p_mean_of_all);
    all.emplace_back(d.p_spread, &d.p_spread_of_all);
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
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

std::string percent(double ratio) { return number_text(100 * (ratio - 1), 3); }

std::string mean_phrase(const LotDifference& d, const FleetComparison& c) {
  if (!in_logarithm(d.quantity))
    return fmt::format("{} of {} is {} {} {} than of {} [{}, {}], {}", title_of(d.quantity), c.name_b,
                       number_text(std::abs(d.change)), d.unit, d.change < 0 ? "lower" : "higher", c.name_a,
                       number_text(d.change_ci95.low), number_text(d.change_ci95.high),
                       probability_text(d.p_mean_of_all));
  // From 2 on, and from a half down, a factor says it better than per cent.
  const bool factor = d.change >= 2 || d.change <= 0.5;
  if (factor)
    return fmt::format("{} of {} is {} times that of {} [{}, {}], {}", title_of(d.quantity), c.name_b,
                       number_text(d.change, 3), c.name_a, number_text(d.change_ci95.low, 3),
                       number_text(d.change_ci95.high, 3), probability_text(d.p_mean_of_all));
  return fmt::format("{} of {} is {} % {} than of {} [{}, {}], {}", title_of(d.quantity), c.name_b,
                     number_text(std::abs(100 * (d.change - 1)), 3), d.change < 1 ? "smaller" : "larger", c.name_a,
                     percent(d.change_ci95.low), percent(d.change_ci95.high), probability_text(d.p_mean_of_all));
}

std::string spread_text(const LotDifference& d, const LotFigures& f) {
  return in_logarithm(d.quantity) ? number_text(100 * f.spread, 3) + " %" : number_text(f.spread, 3) + " " + d.unit;
}

std::string sentence_of(const LotDifference& d, const FleetComparison& c) {
  std::string out = channel_title(d.group, d.type) + ": ";
  if (d.mean_differs) out += mean_phrase(d, c);
  if (d.spread_differs)
    out += fmt::format("{}devices of {} scatter by {}, those of {} by {}, {}",
                       d.mean_differs ? "; " : title_of(d.quantity) + ": ", c.name_b, spread_text(d, d.b), c.name_a,
                       spread_text(d, d.a), probability_text(d.p_spread_of_all));
  if (!d.mean_differs && !d.spread_differs) out += title_of(d.quantity) + ": no difference is resolved";
  return out + ".";
}

std::string comparison_verdict(const FleetComparison& c) {
  const auto differs = std::count_if(c.differences.begin(), c.differences.end(),
                                     [](const auto& d) { return d.mean_differs || d.spread_differs; });
  const std::string what = fmt::format("{} of {} and {} of {}, {}", plural(c.devices_a, "device"), c.name_a,
                                       plural(c.devices_b, "device"), c.name_b, plural(c.tests, "test"));
  const std::string chance = fmt::format(" Lots that are alike give any difference in {} % of comparisons.",
                                         number_text(100 * c.false_alarm, 2));
  if (differs == 0) return what + ": no difference is resolved." + chance;
  return fmt::format("{}: {} of {} quantities differ{}.{}", what, differs, c.differences.size(),
                     differs == 1 ? "s" : "", chance);
}

}  // namespace

FleetComparison compare_lots(Records a, Records b, const CompareLotsOptions& options) {
  Fleet sa = side_of(a, options.name_a), sb = side_of(b, options.name_b);
  FleetComparison out;
  out.name_a = options.name_a;
  out.name_b = options.name_b;
  out.false_alarm = options.false_alarm;
  out.devices_a = sa.sorted.first.size();
  out.devices_b = sb.sorted.first.size();
  bool common = false;
  for (const LotGroup& group : sa.groups) {
    LotGroup* const in_b = group.of_kind ? nullptr : same_channel(sb, group);
    if (in_b == nullptr) continue;
    common = true;
    if (in_b->channel_unit != group.channel_unit) {
      out.notes.push_back(fmt::format("{} is in {} in {} and in {} in {}: compared in {}.",
                                      channel_title(group.name, group.type), group.channel_unit, options.name_a,
                                      in_b->channel_unit, options.name_b, group.channel_unit));
      convert_group(group.channel_unit, *in_b);
    }
    for (const auto& row : enum_table<DeviceQuantity>) {
      const SideValues va = values_of(sa, group, row.value), vb = values_of(sb, *in_b, row.value);
      if (va.effects && vb.effects)
        out.differences.push_back(difference_of(group, va, vb, row.value));
      else
        note_detection(group, va, *in_b, vb, row.value, out);
    }
  }
  if (!common)
    throw input_error("E0753")
        .says("{} and {} have no channel of one type, name and kind of unit in common", options.name_a, options.name_b)
        .hint("compare lots of one type of device");
  note_only(sa, sb, options.name_a, out);
  note_only(sb, sa, options.name_b, out);
  correct_for_all(out);
  for (LotDifference& d : out.differences) d.sentence = sentence_of(d, out);
  out.verdict = comparison_verdict(out);
  return out;
}

}  // namespace libchar
