// A member with several recordings has the value sum w_i y_i / sum w_i, w_i = 1 / (v_i + s²), and the variance 1 / sum w_i, where s is the
// spread from recording to recording of one member, found over all members that have several (core/grouped_effects.hpp): a sensor that
// is switched on again has another bias, and a member that was recorded once is not known better than that.
#include "libchar/lot/detail/quantity_values.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

/// Of values and variances: their sums, squared, have to be numbers.
constexpr double kLargest = 1e60;

/// Ordered: of several recordings of a member the best says what is known of it.
enum class Known { no_result, doubtful, not_detected, counted };

struct Measured {
  Known known = Known::no_result;
  double y = 0, v = 0;
};

Measured measured(const RecordedChannel& channel, DeviceQuantity quantity) {
  const RecordedValue* value = channel.fitted ? channel.find(quantity) : nullptr;
  if (value == nullptr) return {};
  if (value->status == Status::not_detected) return {Known::not_detected};
  if (value->status != Status::detected && value->status != Status::given) return {Known::doubtful};
  const bool logarithm = in_logarithm(quantity);
  const double y = logarithm ? std::log(value->value) : value->value, v = value->sd * value->sd;
  // A square that a double does not hold is no uncertainty either.
  const bool usable =
      std::isfinite(y) && std::abs(y) < kLargest && v > 1 / kLargest && v < kLargest;
  return usable ? Measured{Known::counted, y, v} : Measured{Known::doubtful};
}

void count(Known known, LotCounts& out) {
  ++out.members;
  out.counted += known == Known::counted;
  out.not_detected += known == Known::not_detected;
  out.doubtful += known == Known::doubtful;
  out.no_result += known == Known::no_result;
}

/// All recordings that count, by member.
struct Recordings {
  std::vector<double> y, v;
  std::vector<std::size_t> member;  ///< index into the members that count
};

RepeatedDevices repeated(const Recordings& in, std::size_t members, const GroupedEffects& effects) {
  RepeatedDevices out;
  std::vector<std::size_t> times(members);
  for (const std::size_t m : in.member) ++times[m];
  for (const std::size_t n : times) {
    out.devices += n > 1;
    out.recordings += n > 1 ? n : 0;
  }
  out.within = effects.within;
  out.within_ci95 = effects.within_ci95;
  return out;
}

void take_together(Recordings in, QuantityValues& out) {
  const std::size_t members = out.member.size();
  if (in.y.size() == members || members < 2) {  // one recording each, or nobody to compare with
    for (std::size_t i = 0; i < in.y.size(); ++i)
      if (i == 0 || in.member[i] != in.member[i - 1]) {
        out.y.push_back(in.y[i]);
        out.v.push_back(in.v[i]);
      }
    return;
  }
  GroupedEffects effects = grouped_effects(in.y, in.v, in.member, members);
  out.repeats = repeated(in, members, effects);
  out.y = std::move(effects.mean);
  out.v = std::move(effects.variance);
}

}  // namespace

QuantityValues quantity_values(std::span<const DeviceRecord> records,
                               const LotGroup& group,
                               DeviceQuantity quantity,
                               const std::vector<std::size_t>& batch_of,
                               std::size_t batches) {
  QuantityValues out;
  out.batch_counts.resize(batches);
  Recordings recordings;
  for (std::size_t i = 0; i < group.places.size();) {
    const std::uint32_t member = group.member[i];
    Known best = Known::no_result;
    for (; i < group.places.size() && group.member[i] == member; ++i) {
      const LotPlace& place = group.places[i];
      const Measured one = measured(records[place.recording].channels[place.channel], quantity);
      best = std::max(best, one.known);
      if (one.known != Known::counted) continue;
      recordings.y.push_back(one.y);
      recordings.v.push_back(one.v);
      recordings.member.push_back(out.member.size());
    }
    if (best == Known::counted) out.member.push_back(member);
    count(best, out.counts);
    count(best, out.batch_counts[batch_of[group.devices[member]]]);
  }
  take_together(std::move(recordings), out);
  return out;
}

}  // namespace libchar
