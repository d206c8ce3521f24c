#pragma once
// What the recordings of a group's members say of a quantity, one after the other.

#include <span>
#include <vector>

#include "libchar/lot/detail/lot_figures.hpp"
#include "libchar/lot/detail/lot_groups.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {

/// The recordings that count, by member.
struct MemberRecordings {
  std::vector<double> y, v;           ///< ln(value), or the value, and its variance
  std::vector<double> samples;        ///< of each
  std::vector<double> temperature_c;  ///< NaN: not known
  std::vector<LotPlace> place;
  std::vector<std::size_t> member;     ///< index into `members`
  std::vector<std::uint32_t> members;  ///< of the group, those that count
  /// Of noise terms, the squares of all members whose records were fitted, whether they count or
  /// not; empty where one of them has none. Of several recordings of a member, their mean and the
  /// samples of all.
  LotSquares squares;
  LotCounts counts;
  std::vector<LotCounts> batch_counts;  ///< by batch, as `batch_of` says
};

/// `batch_of`: of each device an index below `batches`.
MemberRecordings member_recordings(std::span<const DeviceRecord> records,
                                   const LotGroup& group,
                                   DeviceQuantity quantity,
                                   const std::vector<std::size_t>& batch_of,
                                   std::size_t batches);

}  // namespace libchar
