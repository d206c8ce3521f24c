#pragma once
// The limits that hold for each group of a fleet, and each device held against them.

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "libchar/characterize/limits.hpp"
#include "libchar/lot/detail/lot_groups.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

/// A limit of a group's term.
struct GroupLimit {
  std::size_t group = 0;
  Term term = Term::white;
  double most = 0;
  std::string text;
};

/// Throws as limits_for, and Error(usage) for limits of a type that no device is of.
std::vector<GroupLimit> group_limits(const std::vector<LotGroup>& groups,
                                     const std::vector<std::string>& types,
                                     const std::map<std::string, NoiseLimits>& limits);

/// A member that fails: its recording and how far it is above.
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
LimitCount judge_members(std::span<const DeviceRecord> records,
                         const LotGroup& group,
                         const GroupLimit& limit);

}  // namespace libchar
