#include "libchar/log/between_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "libchar/core/axis_name.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

constexpr double kGravity = 9.80665;  // m/s^2
constexpr double kTolerance = 0.15;   // biases and scale errors of cheap sensors, and where on Earth
constexpr double kAtRest = 0.05;      // standard deviation of all axes together, in g or of the mean's length

/// Channels that are axes of one sensor, at least one.
struct Axes {
  std::vector<std::size_t> channels;
  bool has_z = false;
};

/// Columns of an array are numbered: acc_0, acc_1, acc_2.
AxisName axis_or_number(const std::string& channel) {
  AxisName name = axis_name(channel);
  const std::size_t n = channel.size();
  if (name.axis != 0 || n < 3 || channel[n - 2] != '_' || channel[n - 1] < '0' || channel[n - 1] > '2') return name;
  name.front = channel.substr(0, n - 2);
  name.axis = static_cast<char>('x' + (channel[n - 1] - '0'));
  return name;
}

std::vector<Axes> axes_of(Quantity quantity, std::span<const Channel> channels) {
  std::map<std::pair<std::string, std::string>, Axes> found;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto unit = find_unit(channels[c].unit);
    if (!unit || unit->quantity != quantity) continue;
    const AxisName name = axis_or_number(channels[c].name);
    if (name.axis == 0) continue;
    Axes& axes = found[{name.front, channels[c].unit}];
    axes.channels.push_back(c);
    axes.has_z = axes.has_z || name.axis == 'z';
  }
  std::vector<Axes> out;
  for (auto& [key, axes] : found) out.push_back(std::move(axes));
  return out;
}

/// Length and scatter of the mean vector.
std::pair<double, double> mean_of(const std::vector<std::size_t>& axes, double unit,
                                  const std::function<ChannelQuality&(std::size_t)>& quality) {
  double mean = 0, scatter = 0;
  for (const std::size_t c : axes) {
    mean += std::pow(quality(c).mean * unit, 2);
    scatter += std::pow(quality(c).standard_deviation * unit, 2);
  }
  return {std::sqrt(mean), std::sqrt(scatter)};
}

void offer_scale(std::span<const Channel> channels, const std::vector<std::size_t>& axes, const std::string& factor,
                 double ratio, Finding& found) {
  Finding::Help help{"Scale the axes."};
  for (const std::size_t c : axes) help.options.push_back({"channel_scale", channels[c].name + "=" + factor});
  found.help.push_back(std::move(help));
  found.effects = {{Affected::scale, ratio < 1 ? Direction::too_small : Direction::too_large, ratio}};
}

bool is_near(double ratio, double wanted) { return std::fabs(ratio / wanted - 1) < kTolerance; }

/// What the length of the mean, in g, speaks for, and the factor that mends it; "" for the factor: none is known.
struct Suspicion {
  std::string says, factor;
};

/// `steady`: the axes scatter by little beside that length.
Suspicion suspicion_of(double ratio, const std::string& stated, bool steady) {
  const double stated_si = find_unit(stated)->to_si;
  double nearest = kTolerance, times = 0;
  std::string real;
  for (const char* unit : {"g", "m/s^2", "mg", "cm/s^2", "mm/s^2"}) {
    const double wanted = rounded(stated_si / find_unit(unit)->to_si, 9);
    const double off = std::fabs(ratio / wanted - 1);
    if (wanted == 1 || off >= nearest || (wanted < kTolerance && !steady)) continue;
    nearest = off;
    real = unit;
    times = wanted;
  }
  if (!real.empty())
    return {fmt::format("this looks like {} under the name of {}", shown_unit(real), shown_unit(stated)),
            times > 1 ? "1/" + shortest(times) : shortest(rounded(find_unit(real)->to_si / stated_si, 9))};
  for (const auto& [wanted, name, factor] :
       {std::tuple{0.5, "half", "2"}, {2.0, "twice", "1/2"}, {0.25, "a quarter of", "4"}, {4.0, "four times", "1/4"}})
    if (is_near(ratio, wanted)) return {fmt::format("this looks like {} the scale", name), factor};
  if (ratio < kTolerance) return {"gravity was taken out, or the sensor does not rest", ""};
  return {"unit or scale are another, or the sensor does not rest", ""};
}

/// One or two axes of three: more than gravity is never right, and an upright axis rarely reads 1 of another unit.
bool some_axes_tell(double ratio, const std::string& stated, bool has_z) {
  constexpr double kExactly = 0.02;
  const double one_g = find_unit(stated)->to_si / kGravity;
  return ratio > 1 || (has_z && one_g < 0.5 && std::fabs(ratio / one_g - 1) < kExactly);
}

void judge_gravity(std::span<const Channel> channels, const std::function<ChannelQuality&(std::size_t)>& quality) {
  for (const Axes& axes : axes_of(Quantity::acceleration, channels)) {
    const std::vector<std::size_t>& all = axes.channels;
    const std::string unit = shown_unit(channels[all[0]].unit);
    const double in_g = find_unit(channels[all[0]].unit)->to_si / kGravity;
    const auto [ratio, scatter] = mean_of(all, in_g, quality);
    const bool steady = scatter < kAtRest * ratio;
    if (!(steady || scatter < kAtRest) || !std::isfinite(ratio) || is_near(ratio, 1)) continue;
    const bool whole = all.size() == 3;
    if (!whole && !some_axes_tell(ratio, channels[all[0]].unit, axes.has_z)) continue;
    const Suspicion suspicion = suspicion_of(ratio, channels[all[0]].unit, steady);
    Finding found =
        finding("not_gravity",
                fmt::format("The mean acceleration of {} is {} {}, and a sensor at rest reads {}{}: {}.",
                            whole             ? "the three axes"
                            : all.size() == 1 ? "the axis"
                                              : "the two axes",
                            brief_text(ratio / in_g, 4), unit,
                            whole       ? ""
                            : ratio > 1 ? "at most "
                                        : "upright ",
                            brief_text(1 / in_g, 4), suspicion.says),
                fmt::format("the mean acceleration is {} {}: {}", brief_text(ratio / in_g, 4), unit, suspicion.says));
    if (ratio < kTolerance && (suspicion.factor.empty() || !whole)) found.severity = Severity::caution;
    if (!suspicion.factor.empty()) offer_scale(channels, all, suspicion.factor, ratio, found);
    for (const std::size_t c : all) quality(c).findings.push_back(found);
  }
}

/// The field of the Earth is 22 to 67 µT. Iron and shields make a tenth or five times of it, and other units more.
void judge_field(std::span<const Channel> channels, const std::function<ChannelQuality&(std::size_t)>& quality) {
  constexpr double kWeakest = 22e-6, kStrongest = 67e-6, kUsual = 45e-6, kShielded = 5e-6, kIron = 3e-4, kSure = 100;
  for (const Axes& axes : axes_of(Quantity::magnetic_field, channels)) {
    const std::vector<std::size_t>& all = axes.channels;
    const std::string& stated = channels[all[0]].unit;
    const double tesla = find_unit(stated)->to_si;
    const auto [field, scatter] = mean_of(all, tesla, quality);
    if (all.size() != 3 || !(scatter < kAtRest * field) || (field > kShielded && field < kIron)) continue;
    for (const char* real : {"T", "mT", "µT", "nT", "Gauss", "mGauss"}) {
      const double times = rounded(find_unit(real)->to_si / tesla, 9), here = field * times;
      if (!(here > kWeakest && here < kStrongest)) continue;
      const std::string says =
          fmt::format("this looks like {} under the name of {}", shown_unit(real), shown_unit(stated));
      const std::string mean = brief_text(field / tesla, 3) + " " + shown_unit(stated);
      Finding found = finding("not_earth_field",
                              fmt::format("The mean field of the three axes is {}, and that of the Earth is 22 to 67 "
                                          "µT: {}.",
                                          mean, says),
                              fmt::format("the mean field is {}: {}", mean, says));
      if (field > kSure * kUsual) found.severity = Severity::bad;  // no magnetometer measures that
      offer_scale(channels, all, times < 1 ? "1/" + shortest(rounded(1 / times, 9)) : shortest(times), 1 / times,
                  found);
      for (const std::size_t c : all) quality(c).findings.push_back(found);
      break;
    }
  }
}

/// Sums over all samples, to the last bit, sign aside: two records that share them are one.
using Fingerprint = std::tuple<std::uint64_t, std::uint64_t, double, double, double, double>;
Fingerprint fingerprint(const ChannelQuality& q) {
  const double sign = q.mean < 0 ? -1 : 1;
  const auto [low, high] = std::minmax({sign * q.minimum, sign * q.maximum});
  return {q.samples, q.missing, sign * q.mean, q.standard_deviation, low, high};
}

void judge_copies(std::span<const Channel> channels, const std::function<ChannelQuality&(std::size_t)>& quality) {
  constexpr std::uint64_t kFewestValues = 32;  ///< of a switch or a coarse grid two may be alike by chance
  std::map<Fingerprint, std::size_t> first;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    ChannelQuality& q = quality(c);
    if (q.distinct_values < kFewestValues || !(q.standard_deviation > 0) || !q.signs.counter.empty()) continue;
    const auto [found, fresh] = first.insert({fingerprint(q), c});
    if (fresh) continue;
    const std::string& other = channels[found->second].name;
    const bool turned = q.mean != quality(found->second).mean;
    Finding copy = finding("copied_channel",
                           fmt::format("Every sample is that of {}{}: one sensor under two names, or an error of what "
                                       "wrote the log.",
                                       printable(other), turned ? " with its sign turned" : ""),
                           fmt::format("repeats {}", printable(other)));
    copy.help.push_back({"Leave it out.", {{"channels", "!" + channels[c].name}}});
    q.findings.push_back(std::move(copy));
  }
}

}  // namespace

void judge_together(std::span<const Channel> channels, const std::function<ChannelQuality&(std::size_t)>& quality) {
  judge_gravity(channels, quality);
  judge_field(channels, quality);
  judge_copies(channels, quality);
}

}  // namespace libchar
