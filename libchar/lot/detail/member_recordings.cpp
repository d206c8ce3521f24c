#include "libchar/lot/detail/member_recordings.hpp"

#include <algorithm>
#include <cmath>

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

Measured measured(const RecordedChannel& channel, DeviceQuantity quantity, double factor) {
  const RecordedValue* value = channel.fitted ? channel.find(quantity) : nullptr;
  if (value == nullptr) return {};
  if (value->status == Status::not_detected) return {Known::not_detected};
  if (value->status != Status::detected && value->status != Status::given) return {Known::doubtful};
  const LogCoefficient in_logarithms =
      in_logarithm(quantity) ? log_coefficient(coefficient_of(*value, factor)) : LogCoefficient{};
  const double sd = factor * value->sd,
               y = in_logarithm(quantity) ? in_logarithms.y : factor * value->value,
               v = in_logarithm(quantity) ? in_logarithms.v : sd * sd;
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

/// Sums over the recordings of a member.
struct SquareSums {
  double count = 0, square = 0, variance = 0, third = 0, samples = 0;
};

/// False where its record was fitted and it has no square.
bool add_square(const RecordedChannel& channel,
                DeviceQuantity quantity,
                double factor,
                SquareSums& sums) {
  const RecordedValue* value = channel.fitted ? channel.find(quantity) : nullptr;
  if (value == nullptr || !was_sought(value->status)) return true;
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

}  // namespace libchar
