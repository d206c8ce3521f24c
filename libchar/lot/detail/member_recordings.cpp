#include "libchar/lot/detail/member_recordings.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/characterize/lot_figures.hpp"
#include "libchar/core/not_known.hpp"

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
  const LogCoefficient in_logarithms =
      in_logarithm(quantity) ? log_coefficient(coefficient_of(*value)) : LogCoefficient{};
  const double y = in_logarithm(quantity) ? in_logarithms.y : value->value,
               v = in_logarithm(quantity) ? in_logarithms.v : value->sd * value->sd;
  // A square that a double does not hold is no uncertainty either.
  const bool usable =
      std::isfinite(y) && std::abs(y) < kLargest && v > 1 / kLargest && v < kLargest;
  return usable ? Measured{Known::counted, y, v} : Measured{Known::doubtful};
}

/// NaN where it is not known, or no temperature.
double temperature_of(const DeviceRecord& record) {
  const double t = record.temperature_c.value_or(kNone);
  return t >= -273.15 && t <= 1e4 ? t : kNone;
}

void count(Known known, LotCounts& out) {
  ++out.members;
  out.counted += known == Known::counted;
  out.not_detected += known == Known::not_detected;
  out.doubtful += known == Known::doubtful;
  out.no_result += known == Known::no_result;
}

}  // namespace

MemberRecordings member_recordings(std::span<const DeviceRecord> records,
                                   const LotGroup& group,
                                   DeviceQuantity quantity,
                                   const std::vector<std::size_t>& batch_of,
                                   std::size_t batches) {
  MemberRecordings out;
  out.batch_counts.resize(batches);
  for (std::size_t i = 0; i < group.places.size();) {
    const std::uint32_t member = group.member[i];
    Known best = Known::no_result;
    for (; i < group.places.size() && group.member[i] == member; ++i) {
      const LotPlace& place = group.places[i];
      const DeviceRecord& record = records[place.recording];
      const Measured one = measured(record.channels[place.channel], quantity);
      best = std::max(best, one.known);
      if (one.known != Known::counted) continue;
      out.y.push_back(one.y);
      out.v.push_back(one.v);
      out.samples.push_back(static_cast<double>(record.channels[place.channel].samples));
      out.temperature_c.push_back(temperature_of(record));
      out.place.push_back(place);
      out.member.push_back(out.members.size());
    }
    if (best == Known::counted) out.members.push_back(member);
    count(best, out.counts);
    count(best, out.batch_counts[batch_of[group.devices[member]]]);
  }
  return out;
}

}  // namespace libchar
