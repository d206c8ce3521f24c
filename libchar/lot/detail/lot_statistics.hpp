#pragma once
// Mean, spread, distribution, chart and capability of every quantity of every group.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/numeric/random_effects.hpp"
#include "libchar/lot/detail/lot_figures.hpp"
#include "libchar/lot/detail/lot_groups.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {
// The values of one quantity in a group: one a member, several recordings of a member taken together.

// What the recordings of a group's members say of a quantity, one after the other.

/// The recordings that count, by member.
struct MemberRecordings {
  std::vector<double> y, v;           ///< ln(value), or the value, and its variance
  std::vector<double> samples;        ///< of each
  std::vector<double> temperature_c;  ///< NaN: not known
  std::vector<LotPlace> place;
  std::vector<std::size_t> member;     ///< index into `members`
  std::vector<std::uint32_t> members;  ///< of the group, those that count
  /// Of noise terms, the squares of all members whose records were fitted, whether they count or not; empty where one
  /// of them has none. Of several recordings of a member, their mean and the samples of all.
  LotSquares squares;
  LotCounts counts;
  std::vector<LotCounts> batch_counts;  ///< by batch, as `batch_of` says
};

struct QuantityValues {
  LotCounts counts;
  std::vector<std::uint32_t> member;  ///< of the group, those that count
  std::vector<double> y, v;           ///< ln(value), or the value, and its variance
  /// Of the records behind each, of noise terms; empty of others.
  std::vector<double> samples;
  /// The variances if what they have in common stood at the ends of its interval; empty where they are known.
  std::vector<double> v_low, v_high;
  LotSquares squares;  ///< of noise terms, also of those that do not count
  std::optional<RepeatedDevices> repeats;
  std::optional<TemperatureRuns> temperatures;
  std::vector<LotCounts> batch_counts;  ///< by batch, as `batch_of` says
};

/// `batch_of`: of each device an index below `batches`.
QuantityValues quantity_values(std::span<const DeviceRecord> records, const LotGroup& group, DeviceQuantity quantity,
                               const std::vector<std::size_t>& batch_of, std::size_t batches);

/// Those of the members of one batch.
QuantityValues values_of_batch(const QuantityValues& all, const LotGroup& group,
                               const std::vector<std::size_t>& batch_of, std::size_t batch);

/// Mean and spread of a quantity over its members.
struct QuantityEffects {
  RandomEffects effects;
  std::optional<ArithmeticFigures> arithmetic;  ///< of what is compared as logarithm
  bool of_all = false;  ///< also of members that do not count, by the squares of what their records show
};

/// Of those that count, where they are enough (lot_figures.hpp); of a noise term that some have and
/// others do not, of all where their squares are known and a third of them was detected.
std::optional<QuantityEffects> effects_of(const QuantityValues& values, bool of_logarithms);

// What the steps of fleet_lot hand to each other.

/// A quantity with the values that it is of.
struct Statistic {
  QuantityLot lot;
  const LotGroup* group = nullptr;
  QuantityValues values;
  LimitCount limit;
  bool limited = false;
};

/// What is made once of all records.
struct Fleet {
  std::span<const DeviceRecord> records;
  SortedRecords sorted;
  std::vector<LotGroup> groups;
  std::vector<std::string> types, batches;
  std::vector<std::size_t> batch_of;  ///< of each device
  std::vector<GroupLimit> limits;
};

Fleet fleet_of(std::span<const DeviceRecord> records, const FleetLotOptions& options);

/// A place of a member: its first.
LotPlace place_of(const LotGroup& group, std::uint32_t member);

/// Of the quantities that any device has something of, group by group. Outliers are not looked for
/// here: each search has a share that depends on how many there are.
std::vector<Statistic> statistics_of(const Fleet& fleet);

}  // namespace libchar
