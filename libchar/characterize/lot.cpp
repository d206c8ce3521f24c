// Coefficients are compared as logarithms, whose standard deviation is the relative one of the fit: y = ln c, v = (sd c / c)². Means
// and spreads are those of core/random_effects.hpp: what the records' lengths alone make the values scatter is taken out.
#include "libchar/characterize/lot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "libchar/characterize/detail/alike_runs.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/log_files.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/term_cells.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/shaped_curves.hpp"

namespace libchar {
namespace {

using Devices = std::span<const Characterization>;

const ChannelResult& channel_of(Devices devices, const LotMember& m) {
  return devices[m.device].channels[m.channel];
}

/// Names of files without folders, or with them where two are alike.
std::vector<std::string> device_names(Devices devices) {
  std::vector<std::string> names;
  for (const Characterization& one : devices) names.push_back(stem_of_log(one.log.file));
  const std::vector<std::string> stems = names;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::count(stems.begin(), stems.end(), stems[i]) > 1) names[i] = devices[i].log.file;
  return names;
}

struct Group {
  std::string name, unit;
  std::vector<LotMember> members;
  bool one_channel = false;  ///< the same channel of several devices
};

/// Channels of one name and unit, and all of one kind and unit, in order of appearance; two members at least.
std::vector<Group> groups_of(Devices devices) {
  std::vector<Group> by_name, by_kind;
  const auto add = [](std::vector<Group>& groups,
                      const std::string& name,
                      const std::string& unit,
                      LotMember m,
                      bool one) {
    auto at = std::find_if(groups.begin(), groups.end(), [&](const Group& g) {
      return g.name == name && g.unit == unit;
    });
    if (at == groups.end()) at = groups.insert(groups.end(), Group{name, unit, {}, one});
    at->members.push_back(m);
  };
  for (std::size_t d = 0; d < devices.size(); ++d)
    for (std::size_t c = 0; c < devices[d].channels.size(); ++c) {
      const Channel& channel = devices[d].channels[c].channel;
      const auto unit = find_unit(channel.unit);
      const std::string symbol = unit ? unit->symbol : channel.unit;
      add(by_name, channel.name, symbol, {d, c}, true);
      add(by_kind,
          unit                   ? fmt::format("{} in {}", name_of(unit->quantity), symbol)
          : channel.unit.empty() ? "no unit"
                                 : "in " + channel.unit,
          symbol,
          {d, c},
          false);
    }
  std::vector<Group> out;
  for (const Group& kind : by_kind) {
    std::size_t names = 0;
    for (const Group& name : by_name)
      names += std::any_of(name.members.begin(),
                           name.members.end(),
                           [&](const LotMember& m) {
                             return m.device == kind.members[0].device &&
                                    m.channel == kind.members[0].channel;
                           }) &&
               name.members.size() == kind.members.size();
    // A kind of one channel only is that channel.
    if (kind.members.size() >= 2 && names == 0) out.push_back(kind);
  }
  for (const Group& name : by_name)
    if (name.members.size() >= 2) out.push_back(name);
  return out;
}

struct Values {
  std::vector<double> y, v, samples;
  LotSquares
      squares;  ///< of a term, also of members that do not count; none where one of them has none
};

void add_square(const Coefficient& found, std::uint64_t samples, bool& known, LotSquares& out) {
  const auto one = square_in_lot(found);
  known = known && (one || !was_sought(found.status));
  if (!one) return;
  out.square.push_back(one->square);
  out.sd.push_back(one->sd);
  out.skewness.push_back(one->skewness);
  out.samples.push_back(static_cast<double>(samples));
}

Values add_values(Devices devices,
                  const Group& group,
                  std::optional<Term> term,
                  LotStatistic& out) {
  Values values;
  bool squared = term.has_value();
  for (const LotMember& m : group.members) {
    const ChannelResult& c = channel_of(devices, m);
    double y = 0, v = 0;
    if (!c.fit) {
      ++out.doubtful;
      continue;
    }
    if (term) {
      const Coefficient& k = (*c.fit)[*term];
      add_square(k, c.fit->samples, squared, values.squares);
      if (k.status == Status::not_detected) ++out.not_detected;
      if (k.status != Status::detected && k.status != Status::not_detected) ++out.doubtful;
      if (k.status != Status::detected || !k.value || !(k.relative_sd > 0)) continue;
      const LogCoefficient one = log_coefficient(k);
      y = one.y;
      v = one.v;
    } else {
      y = c.quality.mean;
      v = mean_noise_variance(*c.fit);
      if (!(v > 0)) continue;
    }
    values.y.push_back(y);
    values.v.push_back(v);
    values.samples.push_back(static_cast<double>(c.fit->samples));
    out.counted.push_back(m);
  }
  if (!squared) values.squares = {};
  return values;
}

/// How far a member is from what the others let expect.
LotOutlier outlier_of(Devices devices,
                      const std::vector<std::string>& names,
                      const LotStatistic& s,
                      const Values& values,
                      const Outlier& found) {
  LotOutlier out;
  out.member = s.counted[found.index];
  out.p = found.p;
  const double value = values.y[found.index];
  const std::string who =
      channel_of(devices, out.member).channel.name + " of " + names[out.member.device];
  if (!s.term) {
    out.sentence = fmt::format("{}: mean {} {}, {} standard deviations from the others ({}).",
                               who,
                               number_text(value),
                               s.unit,
                               number_text(std::abs(found.deviation), 2),
                               probability_text(found.p));
    return out;
  }
  std::vector<double> y = values.y, v = values.v;
  y.erase(y.begin() + static_cast<std::ptrdiff_t>(found.index));
  v.erase(v.begin() + static_cast<std::ptrdiff_t>(found.index));
  const double others = random_effects(y, v).mean;
  out.ratio = std::exp(value - others);
  out.sentence = fmt::format("{}: {} {} {}, {} times that of the others ({}).",
                             who,
                             lot_title(s),
                             number_text(std::exp(value)),
                             s.unit,
                             number_text(out.ratio, 3),
                             probability_text(found.p));
  return out;
}

/// A statistic with the values that it is of.
struct Statistic {
  LotStatistic lot;
  Values values;
};

std::optional<Statistic> statistic_of(Devices devices,
                                      const Group& group,
                                      std::optional<Term> term) {
  Statistic out;
  LotStatistic& lot = out.lot;
  lot.group = group.name;
  lot.of_kind = !group.one_channel;
  lot.term = term;
  const std::string unit = group.unit.empty() ? "U" : group.unit;
  lot.unit = term ? term_unit(kTermNames[static_cast<std::size_t>(*term)].key, unit) : unit;
  lot.members = group.members.size();
  out.values = add_values(devices, group, term, lot);
  if (lot.counted.empty() && (lot.not_detected == 0 || (term && *term >= Term::quantization)))
    return std::nullopt;
  const Values& found = out.values;
  lot.effects = term ? coefficient_effects(found.y, found.v, found.samples, lot.members)
                     : lot_effects(found.y, found.v, lot.members);
  if (const auto all = effects_of_all(found.squares, lot.counted.size(), lot.members)) {
    lot.figures = lot_figures(*all);
    lot.in_figures = all->count;
  } else if (lot.effects) {
    lot.figures = lot_figures(*lot.effects, term.has_value());
    lot.in_figures = lot.counted.size();
  }
  return out;
}

std::vector<Statistic> statistics_of(Devices devices, const LotOptions& options) {
  std::vector<Statistic> out;
  for (const Group& group : groups_of(devices)) {
    for (std::size_t t = 0; t < kTerms; ++t)
      if (auto s = statistic_of(devices, group, static_cast<Term>(t))) out.push_back(std::move(*s));
    if (group.one_channel && options.data == SampleKind::rate)
      if (auto s = statistic_of(devices, group, std::nullopt)) out.push_back(std::move(*s));
  }
  return out;
}

/// Channels of one name and unlike units are no group, which a table of groups does not show.
std::vector<std::string> unlike_units(Devices devices, const std::vector<std::string>& names) {
  std::vector<std::string> out;
  std::map<std::string, std::pair<std::string, std::size_t>> first;
  std::set<std::string> told;
  for (std::size_t d = 0; d < devices.size(); ++d)
    for (const ChannelResult& result : devices[d].channels) {
      const Channel& channel = result.channel;
      const auto known = find_unit(channel.unit);
      const std::string unit = known ? std::string(known->symbol) : channel.unit;
      const auto [at, is_first] = first.try_emplace(channel.name, unit, d);
      if (is_first || at->second.first == unit || !told.insert(channel.name).second) continue;
      const auto in = [](const std::string& u) { return u.empty() ? "without a unit" : "in " + u; };
      out.push_back(fmt::format("{} is {} in {} and {} in {}: not compared.",
                                channel.name,
                                in(at->second.first),
                                names[at->second.second],
                                in(unit),
                                names[d]));
    }
  return out;
}

std::string lot_verdict(const Lot& lot) {
  std::vector<LotMember> named;
  for (const LotStatistic& s : lot.statistics)
    for (const LotOutlier& o : s.outliers)
      if (std::none_of(named.begin(), named.end(), [&](const LotMember& m) {
            return m.device == o.member.device && m.channel == o.member.channel;
          }))
        named.push_back(o.member);
  const std::string devices =
      fmt::format("{} recording{}", lot.devices.size(), lot.devices.size() == 1 ? "" : "s");
  std::string out = named.empty() ? devices + ": no channel stands out from its kind."
                                  : fmt::format("{}: {} channel{} out from {} kind.",
                                                devices,
                                                named.size(),
                                                named.size() == 1 ? " stands" : "s stand",
                                                named.size() == 1 ? "its" : "their");
  for (const std::string& sentence : lot.not_compared) out += " " + sentence;
  return out;
}

}  // namespace

Lot lot_of(Devices devices, const LotOptions& options) {
  std::size_t channels = 0;
  for (const Characterization& one : devices) channels += one.channels.size();
  if (channels < 2)
    throw Error({ErrorKind::usage,
                 "E0205",
                 "",
                 "one channel is no lot",
                 "",
                 "name several recordings, or one with several channels"});
  check_files(devices);
  Lot lot;
  lot.devices = device_names(devices);
  lot.not_compared = unlike_units(devices, lot.devices);
  std::vector<Statistic> statistics = statistics_of(devices, options);
  const double share = options.outlier_probability /
                       static_cast<double>(std::max<std::size_t>(1, statistics.size()));
  for (Statistic& s : statistics) {
    if (s.lot.effects)
      for (const Outlier& found : find_outliers(s.values.y, s.values.v, share))
        s.lot.outliers.push_back(outlier_of(devices, lot.devices, s.lot, s.values, found));
    lot.statistics.push_back(std::move(s.lot));
  }
  lot.verdict = lot_verdict(lot);
  return lot;
}

std::string lot_title(const LotStatistic& s) {
  return s.term ? term_title(*s.term) : "Mean";
}

}  // namespace libchar
