#pragma once
// Records sorted into devices and into groups of channels that can be compared.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/limits.hpp"
#include "libchar/lot/device_record.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

/// Indices into the records.
struct LotPlace {
  std::uint32_t recording = 0, channel = 0;
};

struct LotGroup {
  std::string type, name;    ///< the name of a channel, or of a kind
  std::string measures;      ///< what its units have in common: "angular_rate"
  std::string channel_unit;  ///< that of most recordings, in its canonical spelling
  /// Of each unit as its recordings spell it: a value times this is in `channel_unit`.
  std::map<std::string, double> factor;
  bool of_kind = false;
  std::vector<LotPlace> places;        ///< those of one member follow each other
  std::vector<std::uint32_t> member;   ///< of each place: 0, 1, … in order
  std::vector<std::uint32_t> devices;  ///< of each member
};

struct SortedRecords {
  std::vector<std::size_t> order;      ///< by type, batch, device, log, without copies
  std::vector<std::size_t> device_of;  ///< of each record; kNoDevice: a copy
  std::vector<std::size_t> first;      ///< recording of each device
  std::vector<std::string> batch;      ///< of each device
  std::vector<std::string> notes;
};
inline constexpr std::size_t kNoDevice = static_cast<std::size_t>(-1);

SortedRecords sorted_records(std::span<const DeviceRecord> records);

/// The unit, or "no unit".
std::string unit_title(const std::string& channel_unit);
/// "gx of imu-x", or "gx" without a type.
std::string channel_title(const std::string& channel, const std::string& type);

/// Channels of one type and name whose units are of one quantity; and, where a type has several of
/// one kind, all of them. Kinds first.
std::vector<LotGroup> lot_groups(std::span<const DeviceRecord> records, const SortedRecords& sorted);

/// Who stands out is asked of a channel among devices, and of a kind only where one device has all
/// of its channels: what axes of every device differ by is no device's fault.
bool shows_outliers(const LotGroup& group);

/// What a value of the channel is multiplied by to be in the unit of the group's.
double factor_of(const LotGroup& group, const RecordedChannel& channel, DeviceQuantity quantity);

/// Gives a group the unit of another one that measures the same.
void convert_group(const std::string& channel_unit, LotGroup& group);

/// Channels of one type and name in several units, whether they can be converted or not; records
/// made with unlike settings or versions.
std::vector<std::string> unlike_records(std::span<const DeviceRecord> records, const SortedRecords& sorted,
                                        const std::vector<LotGroup>& groups);

// The limits that hold for each group of a fleet, and each device held against them.

/// A limit of a group's term.
struct GroupLimit {
  std::size_t group = 0;
  Term term = Term::white;
  double most = 0;
  std::string text;
};

/// Throws as limits_for, and Error(usage) for limits of a type that no device is of.
std::vector<GroupLimit> group_limits(const std::vector<LotGroup>& groups, const std::vector<std::string>& types,
                                     const std::map<std::string, NoiseLimits>& limits);

/// A member that fails: its recording and its progress above.
struct LimitFailure {
  std::uint32_t member = 0;
  LotPlace place;
  double p = 1;          ///< of as high a value of a device that stands at the limit
  double deviation = 0;  ///< in standard deviations
  std::string sentence;
};

struct LimitCount {
  std::size_t pass = 0, fail = 0, not_decided = 0;
  std::vector<LimitStatus> status;  ///< of each member: of its recordings the worst
  std::vector<LimitFailure> failures;
};
LimitCount judge_members(std::span<const DeviceRecord> records, const LotGroup& group, const GroupLimit& limit);

}  // namespace libchar
