// Coefficients are compared as logarithms. Means and spreads are those of core/random_effects.hpp: what the records' lengths alone make
// the values scatter is taken out, so that the spread is that of the devices.
#include "libchar/lot/fleet_lot.hpp"

#include <fmt/format.h>

#include "libchar/core/error.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/lot/detail/fleet_data.hpp"
#include "libchar/lot/detail/fleet_verdict.hpp"
#include "libchar/lot/detail/statistics/lot_outliers.hpp"
#include "libchar/lot/detail/statistics/lot_statistics.hpp"
#include "libchar/lot/detail/worst_devices.hpp"

namespace libchar {
namespace {

/// What was mended in the logs does not get lost in the number of them.
std::vector<std::string> warnings_note(std::span<const DeviceRecord> records,
                                       std::span<const std::size_t> order) {
  const DeviceRecord* first = nullptr;
  std::size_t count = 0;
  for (const std::size_t r : order) {
    if (records[r].warnings.empty()) continue;
    if (++count == 1) first = &records[r];
  }
  if (count == 0) return {};
  return {fmt::format("{} of {} read with warnings, which their pages say; the first, of {}: {}",
                      count,
                      plural(records.size(), "recording"),
                      first->device,
                      first->warnings[0])};
}

}  // namespace

FleetLot fleet_lot(std::span<const DeviceRecord> records, const FleetLotOptions& options) {
  if (records.empty())
    throw Error({ErrorKind::usage,
                 "E0752",
                 "",
                 "a lot needs at least one device record, there is none",
                 "",
                 "characterize the fleet's logs first"});
  const Fleet fleet = fleet_of(records, options);
  FleetLot out;
  out.devices = fleet.sorted.first.size();
  out.order = fleet.sorted.order;
  for (const std::size_t r : out.order)
    if (!records[r].problem.empty()) (records[r].awaited ? out.awaited : out.failed).push_back(r);
  out.types = fleet.types;
  out.batches = fleet.batches;
  out.batch_of.resize(records.size());
  for (const std::size_t r : out.order) out.batch_of[r] = fleet.batch_of[fleet.sorted.device_of[r]];
  std::vector<Statistic> statistics = statistics_of(fleet);
  search_outliers(fleet, options.outlier_probability, statistics);
  mark_devices(fleet, statistics, out);
  add_worst(fleet, statistics, options.worst, out);
  for (Statistic& s : statistics) out.quantities.push_back(std::move(s.lot));
  out.notes = fleet.sorted.notes;
  for (std::string& note : unlike_records(records, fleet.sorted, fleet.groups))
    out.notes.push_back(std::move(note));
  for (std::string& note : warnings_note(records, out.order)) out.notes.push_back(std::move(note));
  out.verdict = fleet_verdict(out);
  return out;
}

}  // namespace libchar
