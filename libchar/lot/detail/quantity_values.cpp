// A member with several recordings has the value sum w_i y_i / sum w_i, w_i = 1 / (v_i + s²), and the variance 1 / sum
// w_i, where s is the spread from recording to recording of one member, found over all members that have several
// (detail/grouped_effects.hpp): a sensor that is switched on again has another bias, and a member that was recorded
// once is not known better than that. Where members were recorded at several temperatures their biases are those of
// their lines (temperature_lines.cpp). A temperature coefficient is found inside a recording that has a thermometer, or
// as the slope of the biases of several recordings. One lot has one of both, never a mixture: the one that counts for
// more members; as many: that inside recordings, which knows the bias of one switching on only. The slopes' error is
// estimated, s² with f degrees of freedom, and a spread over it has to know that. The two errors of
// spread² = total - error are independent and each has its interval, so that they join by the method of variance
// estimates recovery (Zou & Donner, Stat. Med. 27 (2008) 1693), with P the square that Paule and Mandel's equation
// gives:
//   low² = P - hypot(P - low²(s known), P - P(s at its upper end)),
//   high² = P + hypot(high²(s known) - P, P(s at its lower end) - P)

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/lot/detail/lot_statistics.hpp"
#include "libchar/lot/detail/statistics/grouped_effects.hpp"

namespace libchar {
namespace {

// The turn-on bias of devices that were recorded at several temperatures.

/// A line over temperature of each member that has several, a mean of all others.
struct TemperatureLines {
  MemberRecordings recordings;  ///< without those of such members whose temperature is not known
  std::vector<bool> sloped;     ///< of each member that counts
  GroupedLines lines;           ///< x = temperature - reference
  TemperatureRuns runs;         ///< without slopes
};

constexpr Interval kNothing = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

void widen(Interval& range, double value) {
  if (std::isnan(value)) return;
  range = {std::min(range.low, value), std::max(range.high, value)};
}

/// Temperatures of each member that counts.
std::vector<Interval> temperature_ranges(const MemberRecordings& in) {
  std::vector<Interval> out(in.members.size(), kNothing);
  for (std::size_t i = 0; i < in.y.size(); ++i) widen(out[in.member[i]], in.temperature_c[i]);
  return out;
}

/// A member with a line has no use for a recording of which the temperature is not known.
MemberRecordings of_known_temperature(const MemberRecordings& in, const std::vector<bool>& sloped) {
  MemberRecordings out;
  out.members = in.members;
  out.counts = in.counts;
  out.batch_counts = in.batch_counts;
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    if (sloped[in.member[i]] && std::isnan(in.temperature_c[i])) continue;
    out.y.push_back(in.y[i]);
    out.v.push_back(in.v[i]);
    out.temperature_c.push_back(in.temperature_c[i]);
    out.place.push_back(in.place[i]);
    out.member.push_back(in.member[i]);
  }
  return out;
}

/// The lower one of two: a temperature at which something was recorded.
double median_temperature(const MemberRecordings& in) {
  std::vector<double> known;
  for (const double t : in.temperature_c)
    if (!std::isnan(t)) known.push_back(t);
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>((known.size() - 1) / 2);
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

TemperatureRuns runs_of(const MemberRecordings& in, const std::vector<Interval>& ranges,
                        const std::vector<bool>& sloped) {
  TemperatureRuns out;
  out.range_c = kNothing;
  out.reference_c = median_temperature(in);
  for (std::size_t i = 0; i < in.y.size(); ++i) out.recordings += sloped[in.member[i]];
  for (std::size_t m = 0; m < sloped.size(); ++m) {
    const Interval& at = ranges[m];
    if (sloped[m]) {
      ++out.devices;
      widen(out.range_c, at.low);
      widen(out.range_c, at.high);
    } else if (at.low <= at.high) {
      out.elsewhere +=
          at.low - out.reference_c >= kLeastTemperatureSpan || out.reference_c - at.high >= kLeastTemperatureSpan;
    }
  }
  return out;
}

/// Nothing where no member's temperatures lie kLeastTemperatureSpan apart.
std::optional<TemperatureLines> temperature_lines(const MemberRecordings& biases) {
  const std::vector<Interval> ranges = temperature_ranges(biases);
  std::vector<bool> sloped(ranges.size());
  for (std::size_t m = 0; m < ranges.size(); ++m) sloped[m] = ranges[m].high - ranges[m].low >= kLeastTemperatureSpan;
  if (std::find(sloped.begin(), sloped.end(), true) == sloped.end()) return std::nullopt;
  TemperatureLines out;
  out.recordings = of_known_temperature(biases, sloped);
  out.runs = runs_of(out.recordings, ranges, sloped);
  std::vector<double> x = out.recordings.temperature_c;
  for (double& t : x) t -= out.runs.reference_c;
  out.lines = grouped_lines(out.recordings.y, out.recordings.v, x, out.recordings.member, sloped);
  out.sloped = std::move(sloped);
  out.runs.repeatability = out.lines.within;
  out.runs.repeatability_ci95 = out.lines.within_ci95;
  out.runs.dof = out.lines.dof;
  return out;
}

/// Of each member with a line, in order.
std::vector<DeviceSlope> device_slopes(const TemperatureLines& at) {
  if (at.lines.dof < 1) return {};
  std::vector<DeviceSlope> out;
  const double t = student_quantile(0.975, at.lines.dof);
  const MemberRecordings& in = at.recordings;
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    const std::size_t m = in.member[i];
    if (!at.sloped[m]) continue;
    if (i == 0 || in.member[i - 1] != m) {
      const double slope = at.lines.slope[m], half = t * std::sqrt(at.lines.slope_variance[m]);
      out.push_back({in.place[i].recording, in.place[i].channel, 0, kNothing, slope, {slope - half, slope + half}});
    }
    ++out.back().recordings;
    widen(out.back().temperature_c, in.temperature_c[i]);
  }
  return out;
}

/// Of values and variances: their sums, squared, have to be numbers.
constexpr double kLargest = 1e60;

/// Ordered: of several recordings of a member the best says what is known of it.
enum class Known { no_result, spoilt, doubtful, not_detected, counted };

struct Measured {
  Known known = Known::no_result;
  double y = 0, v = 0;
};

Measured measured(const RecordedChannel& channel, DeviceQuantity quantity, double factor) {
  const RecordedValue* value = channel.fitted ? channel.find(quantity) : nullptr;
  if (value == nullptr) return {};
  const bool detected = value->status == Status::detected || value->status == Status::given;
  if (!detected && value->status != Status::not_detected) return {Known::doubtful};
  if (channel.is_spoilt(quantity)) return {Known::spoilt};
  if (!detected) return {Known::not_detected};
  const LogCoefficient in_logarithms =
      in_logarithm(quantity) ? log_coefficient(coefficient_of(*value, factor)) : LogCoefficient{};
  const double sd = factor * value->sd, y = in_logarithm(quantity) ? in_logarithms.y : factor * value->value,
               v = in_logarithm(quantity) ? in_logarithms.v : sd * sd;
  // A square that a double does not hold is no uncertainty either.
  const bool usable = std::isfinite(y) && std::abs(y) < kLargest && v > 1 / kLargest && v < kLargest;
  return usable ? Measured{Known::counted, y, v} : Measured{Known::doubtful};
}

/// NaN where it is not known, or no temperature.
double temperature_of(const DeviceRecord& record) {
  const double t = record.temperature_c.value_or(kNone);
  return t >= -273.15 && t <= 1e4 ? t : kNone;
}

/// Sums over the recordings of a member.
struct SquareSums {
  double count = 0, square = 0, variance = 0, third = 0, samples = 0;
};

/// False where its record was fitted and it has no square.
bool add_square(const RecordedChannel& channel, DeviceQuantity quantity, double factor, SquareSums& sums) {
  const RecordedValue* value = channel.fitted ? channel.find(quantity) : nullptr;
  if (value == nullptr || !was_sought(value->status) || channel.is_spoilt(quantity)) return true;
  const auto one = square_in_lot(coefficient_of(*value, factor));
  if (!one) return false;
  sums.count += 1;
  sums.square += one->square;
  sums.variance += one->sd * one->sd;
  sums.third += one->skewness * one->sd * one->sd * one->sd;
  sums.samples += static_cast<double>(channel.samples);
  return std::abs(one->square) < kLargest && one->sd < kLargest && one->sd > 1 / kLargest;
}

void add_member(const SquareSums& sums, std::uint32_t member, LotSquares& out) {
  if (sums.count == 0) return;
  out.square.push_back(sums.square / sums.count);
  out.sd.push_back(std::sqrt(sums.variance) / sums.count);
  out.skewness.push_back(sums.third / std::pow(sums.variance, 1.5));
  out.samples.push_back(sums.samples);
  out.member.push_back(member);
}

void count(Known known, LotCounts& out) {
  ++out.members;
  out.counted += known == Known::counted;
  out.not_detected += known == Known::not_detected;
  out.doubtful += known == Known::doubtful;
  out.spoilt += known == Known::spoilt;
  out.no_result += known == Known::no_result;
}

/// `batch_of`: of each device an index below `batches`.
MemberRecordings member_recordings(std::span<const DeviceRecord> records, const LotGroup& group,
                                   DeviceQuantity quantity, const std::vector<std::size_t>& batch_of,
                                   std::size_t batches) {
  MemberRecordings out;
  out.batch_counts.resize(batches);
  bool squared = term_of(quantity).has_value();
  for (std::size_t i = 0; i < group.places.size();) {
    const std::uint32_t member = group.member[i];
    Known best = Known::no_result;
    SquareSums squares;
    for (; i < group.places.size() && group.member[i] == member; ++i) {
      const LotPlace& place = group.places[i];
      const DeviceRecord& record = records[place.recording];
      const RecordedChannel& channel = record.channels[place.channel];
      const double factor = factor_of(group, channel, quantity);
      const Measured one = measured(channel, quantity, factor);
      best = std::max(best, one.known);
      squared = squared && add_square(channel, quantity, factor, squares);
      if (one.known != Known::counted) continue;
      out.y.push_back(one.y);
      out.v.push_back(one.v);
      out.samples.push_back(static_cast<double>(channel.samples));
      out.temperature_c.push_back(temperature_of(record));
      out.place.push_back(place);
      out.member.push_back(out.members.size());
    }
    if (best == Known::counted) out.members.push_back(member);
    if (squared) add_member(squares, member, out.squares);
    count(best, out.counts);
    count(best, out.batch_counts[batch_of[group.devices[member]]]);
  }
  if (!squared) out.squares = {};
  return out;
}

/// Those with more recordings than their means and lines take.
RepeatedDevices repeated(const std::vector<std::size_t>& recordings, const std::vector<std::size_t>& taken,
                         double within, const Interval& within_ci95) {
  RepeatedDevices out{0, 0, within, within_ci95};
  for (std::size_t m = 0; m < recordings.size(); ++m) {
    const bool repeats = recordings[m] > taken[m];
    out.devices += repeats;
    out.recordings += repeats ? recordings[m] : 0;
  }
  return out;
}

std::vector<std::size_t> recordings_of(const MemberRecordings& in) {
  std::vector<std::size_t> out(in.members.size());
  for (const std::size_t m : in.member) ++out[m];
  return out;
}

void take_together(const MemberRecordings& in, QuantityValues& out) {
  const std::size_t members = in.members.size();
  if (in.y.size() == members || members < 2) {  // one recording each, or nobody to compare with
    for (std::size_t i = 0; i < in.y.size(); ++i)
      if (i == 0 || in.member[i] != in.member[i - 1]) {
        out.y.push_back(in.y[i]);
        out.v.push_back(in.v[i]);
      }
    return;
  }
  GroupedEffects effects = grouped_effects(in.y, in.v, in.member, members);
  out.repeats = repeated(recordings_of(in), std::vector<std::size_t>(members, 1), effects.within, effects.within_ci95);
  out.y = std::move(effects.mean);
  out.v = std::move(effects.variance);
}

void take_lines(TemperatureLines at, QuantityValues& out) {
  std::vector<std::size_t> taken;
  for (const bool line : at.sloped) taken.push_back(line ? 2 : 1);
  if (at.lines.dof >= 1)
    out.repeats = repeated(recordings_of(at.recordings), taken, at.lines.within, at.lines.within_ci95);
  out.y = std::move(at.lines.at_zero);
  out.v = std::move(at.lines.at_zero_variance);
  out.temperatures = std::move(at.runs);
}

/// A lot of slopes is one of the members that have one: the others were not recorded so.
QuantityValues slope_values(const TemperatureLines& at, const LotGroup& group, const std::vector<std::size_t>& batch_of,
                            std::size_t batches) {
  QuantityValues out;
  out.batch_counts.resize(batches);
  for (std::size_t m = 0; m < at.sloped.size(); ++m) {
    if (!at.sloped[m]) continue;
    const std::uint32_t member = at.recordings.members[m];
    out.member.push_back(member);
    out.y.push_back(at.lines.slope[m]);
    out.v.push_back(at.lines.slope_variance[m]);
    out.v_low.push_back(at.lines.slope_variance_low[m]);
    out.v_high.push_back(at.lines.slope_variance_high[m]);
    for (LotCounts* counts : {&out.counts, &out.batch_counts[batch_of[group.devices[member]]]}) {
      ++counts->members;
      ++counts->counted;
    }
  }
  out.temperatures = at.runs;
  out.temperatures->slopes = device_slopes(at);
  return out;
}

}  // namespace

QuantityValues quantity_values(std::span<const DeviceRecord> records, const LotGroup& group, DeviceQuantity quantity,
                               const std::vector<std::size_t>& batch_of, std::size_t batches) {
  const auto recordings = [&](DeviceQuantity of) { return member_recordings(records, group, of, batch_of, batches); };
  const MemberRecordings found = recordings(quantity);
  if (quantity == DeviceQuantity::temperature_coefficient) {
    const auto at = temperature_lines(recordings(DeviceQuantity::turn_on_bias));
    if (at && at->lines.dof >= 1 && at->runs.devices > found.counts.counted) {
      QuantityValues out = slope_values(*at, group, batch_of, batches);
      out.temperatures->in_one_recording = found.counts.counted;
      return out;
    }
  }
  QuantityValues out;
  out.counts = found.counts;
  out.batch_counts = found.batch_counts;
  out.member = found.members;
  out.squares = found.squares;
  auto at = quantity == DeviceQuantity::turn_on_bias ? temperature_lines(found) : std::nullopt;
  if (at)
    take_lines(*std::move(at), out);
  else
    take_together(found, out);
  if (term_of(quantity)) {
    out.samples.resize(out.y.size());
    for (std::size_t i = 0; i < found.member.size(); ++i) out.samples[found.member[i]] += found.samples[i];
  }
  return out;
}

QuantityValues values_of_batch(const QuantityValues& all, const LotGroup& group,
                               const std::vector<std::size_t>& batch_of, std::size_t batch) {
  QuantityValues out;
  out.counts = all.batch_counts[batch];
  const auto take = [&](const std::vector<std::uint32_t>& member, const std::vector<double>& from,
                        std::vector<double>& to) {
    for (std::size_t i = 0; i < from.size(); ++i)
      if (batch_of[group.devices[member[i]]] == batch) to.push_back(from[i]);
  };
  for (const auto values : {&QuantityValues::y, &QuantityValues::v, &QuantityValues::samples, &QuantityValues::v_low,
                            &QuantityValues::v_high})
    take(all.member, all.*values, out.*values);
  for (const auto values : {&LotSquares::square, &LotSquares::sd, &LotSquares::skewness, &LotSquares::samples})
    take(all.squares.member, all.squares.*values, out.squares.*values);
  return out;
}

namespace {

std::optional<RandomEffects> effects_of_counted(const QuantityValues& values) {
  if (!values.samples.empty()) return coefficient_effects(values.y, values.v, values.samples, values.counts.members);
  auto out = lot_effects(values.y, values.v, values.counts.members);
  if (!out || values.v_low.empty()) return out;
  const auto square = [](double x) { return x * x; };
  const double p = square(out->spread);
  const double below = p - square(random_effects(values.y, values.v_high).spread),
               above = square(random_effects(values.y, values.v_low).spread) - p;
  Interval& ci95 = out->spread_ci95;
  ci95 = {std::sqrt(std::max(0.0, p - std::hypot(p - square(ci95.low), below))),
          std::sqrt(p + std::hypot(square(ci95.high) - p, above))};
  return out;
}

}  // namespace

std::optional<QuantityEffects> effects_of(const QuantityValues& values, bool of_logarithms) {
  if (const auto all = effects_of_all(values.squares, values.counts.counted, values.counts.members))
    return QuantityEffects{
        {all->count, all->mean, all->mean_ci95, all->spread, all->spread_ci95, kNone}, arithmetic_figures(*all), true};
  const auto counted = effects_of_counted(values);
  if (!counted) return std::nullopt;
  QuantityEffects out{*counted, std::nullopt, false};
  if (!of_logarithms) return out;
  // Records of a process's parameters are taken as alike.
  const std::vector<double> alike(values.y.size(), 1.0);
  out.arithmetic = arithmetic_figures(values.y, values.v, values.samples.empty() ? alike : values.samples);
  return out;
}

}  // namespace libchar
