#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/axis_name.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

/// As the field calls a sensor of the quantity.
std::string word_for(Quantity quantity) {
  switch (quantity) {
    case Quantity::angular_rate:
      return "gyro";
    case Quantity::acceleration:
      return "accel";
    case Quantity::magnetic_field:
      return "mag";
    case Quantity::pressure:
      return "baro";
    default:
      return std::string(name_of(quantity));
  }
}

std::string axis_in(std::string_view name) {
  const char axis = axis_name(name).axis;
  return axis == 0 ? "" : std::string(1, axis);
}

std::string with_axis(const std::string& word, const std::string& axis) {
  return axis.empty() ? word : word + "_" + axis;
}

}  // namespace

namespace detail {

std::string usual_channel_name(std::string_view name, std::string_view unit) {
  const auto known = find_unit(unit);
  if (!known || known->quantity == Quantity::ratio) return std::string(name);
  return with_axis(word_for(known->quantity), axis_in(name));
}

namespace {

using Pairs = std::vector<ChannelPairs>;

ChannelPairs& group_for(Pairs& pairs, const ReportedChannel& channel) {
  const auto unit = find_unit(channel.unit);
  ComparedGroup key;
  key.name = usual_channel_name(channel.name, channel.unit);
  key.unit = channel.unit;
  const bool known = unit && unit->quantity != Quantity::ratio;
  if (known) {
    key.quantity = name_of(unit->quantity);
    key.axis = axis_in(channel.name);
  }
  for (ChannelPairs& one : pairs)
    if (one.group.name == key.name && one.group.quantity == key.quantity && (known || one.group.unit == key.unit))
      return one;
  return pairs.emplace_back(ChannelPairs{key, {}});
}

std::size_t count_of(const ChannelPairs& pairs, std::size_t side) {
  return static_cast<std::size_t>(std::count_if(pairs.channels.begin(), pairs.channels.end(),
                                                [&](const PairedChannel& one) { return one.side == side; }));
}

std::size_t sides_of(const ChannelPairs& pairs) {
  std::set<std::size_t> sides;
  for (const PairedChannel& one : pairs.channels) sides.insert(one.side);
  return sides.size();
}

/// Where a side has several channels that measure the same, those of one name belong together first.
void split_by_name(const ChannelPairs& all, Pairs& out) {
  const bool several =
      std::any_of(all.channels.begin(), all.channels.end(), [&](const auto& c) { return count_of(all, c.side) > 1; });
  if (!several || sides_of(all) < 2) return out.push_back(all);
  ChannelPairs rest{all.group, {}};
  Pairs named;
  for (const PairedChannel& one : all.channels) {
    const auto same = [&](const PairedChannel& c) { return c.channel->name == one.channel->name; };
    if (std::count_if(all.channels.begin(), all.channels.end(), same) < 2) {
      rest.channels.push_back(one);
      continue;
    }
    auto place = std::find_if(named.begin(), named.end(),
                              [&](const ChannelPairs& p) { return p.channels[0].channel->name == one.channel->name; });
    if (place == named.end()) {
      place = named.insert(named.end(), ChannelPairs{all.group, {}});
      place->group.name = one.channel->name;
    }
    place->channels.push_back(one);
  }
  out.insert(out.end(), named.begin(), named.end());
  if (!rest.channels.empty()) out.push_back(rest);
}

/// A channel without an axis, such as a data sheet's one gyroscope, stands for each axis of its quantity.
void spread_over_axes(Pairs& pairs) {
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const ChannelPairs plain = pairs[k];
    if (!plain.group.axis.empty() || plain.group.quantity.empty()) continue;
    std::set<std::size_t> taken;
    for (ChannelPairs& other : pairs) {
      if (other.group.axis.empty() || other.group.quantity != plain.group.quantity) continue;
      for (const PairedChannel& one : plain.channels)
        if (count_of(plain, one.side) == 1 && count_of(other, one.side) == 0) {
          other.channels.push_back(one);
          taken.insert(one.side);
        }
    }
    std::erase_if(pairs[k].channels, [&](const auto& c) { return taken.contains(c.side); });
  }
  std::erase_if(pairs, [](const ChannelPairs& one) { return one.channels.empty(); });
}

void refuse_unmatched_channels(const std::vector<ReportedCharacterization>& sides,
                               const std::vector<std::string>& wanted) {
  std::vector<std::string> names;
  for (const ReportedCharacterization& side : sides)
    for (const ReportedChannel& c : side.channels)
      for (const std::string& name : {c.name, usual_channel_name(c.name, c.unit)})
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  for (const std::string& one : wanted)
    if (std::none_of(names.begin(), names.end(), [&](const auto& n) { return matches(one, n); }))
      throw usage_error("E0977", "`channels`")
          .says("nothing has this name")
          .got(one)
          .hint(did_you_mean(nearest(one, names), "there are " + first_names(names)));
}

void set_unit_factors(ChannelPairs& pairs) {
  pairs.group.unit = pairs.channels[0].channel->unit;
  for (PairedChannel& one : pairs.channels) one.factor = unit_factor(one.channel->unit, pairs.group.unit).value_or(1);
}

}  // namespace

bool is_chosen(const ReportedChannel& channel, const std::vector<std::string>& wanted) {
  return wanted.empty() || std::any_of(wanted.begin(), wanted.end(), [&](const std::string& one) {
           return matches(one, channel.name) || matches(one, usual_channel_name(channel.name, channel.unit));
         });
}

std::vector<ChannelPairs> paired_channels(const std::vector<ReportedCharacterization>& sides,
                                          const std::vector<std::string>& wanted) {
  refuse_unmatched_channels(sides, wanted);
  Pairs all, out;
  for (std::size_t s = 0; s < sides.size(); ++s)
    for (const ReportedChannel& channel : sides[s].channels)
      if (is_chosen(channel, wanted)) group_for(all, channel).channels.push_back({s, &channel, 1});
  spread_over_axes(all);
  for (const ChannelPairs& one : all) split_by_name(one, out);
  for (ChannelPairs& one : out) {
    std::stable_sort(one.channels.begin(), one.channels.end(),
                     [](const auto& a, const auto& b) { return a.side < b.side; });
    set_unit_factors(one);
  }
  return out;
}

std::vector<AxesTogether> axes_together(const std::vector<ChannelPairs>& pairs) {
  std::vector<AxesTogether> out;
  std::set<std::string> done;
  for (const ChannelPairs& first : pairs) {
    if (first.group.axis.empty() || !done.insert(first.group.quantity).second) continue;
    std::vector<const ChannelPairs*> axes;
    for (const ChannelPairs& one : pairs)
      if (one.group.quantity == first.group.quantity && !one.group.axis.empty() && sides_of(one) >= 2)
        axes.push_back(&one);
    if (axes.size() < 2) continue;
    AxesTogether together{axes[0]->group, {}};
    std::vector<std::string> letters;
    for (const ChannelPairs* axis : axes) letters.push_back(axis->group.axis);
    for (const PairedChannel& one : axes[0]->channels) {
      std::vector<PairedChannel> of_side;
      for (const ChannelPairs* axis : axes)
        for (const PairedChannel& c : axis->channels)
          if (c.side == one.side && count_of(*axis, one.side) == 1) {
            of_side.push_back(c);
            of_side.back().factor *= unit_factor(axis->group.unit, together.group.unit).value_or(1);
          }
      if (of_side.size() == axes.size()) together.sides.push_back(of_side);
    }
    if (together.sides.size() < 2 || std::set(letters.begin(), letters.end()).size() != axes.size()) continue;
    together.group.of_axes = true;
    together.group.axis.clear();
    together.group.name = usual_channel_name("", together.group.unit) + fmt::format(" ({})", fmt::join(letters, ", "));
    out.push_back(std::move(together));
  }
  return out;
}

}  // namespace detail
}  // namespace libchar
