#include "libchar/fleet/status.hpp"

#include "libchar/core/error.hpp"
#include "libchar/fleet/detail/log_seen.hpp"
#include "libchar/fleet/detail/result_store.hpp"

namespace libchar {
namespace {

enum class Found { nothing, result, no_result };

Found look_at(const FleetUnit& unit, const std::filesystem::path& folder) {
  if (unit.kind == UnitKind::stretch)
    return !stored_states(folder, unit.id).empty() && result_counts(folder, unit) ? Found::result
                                                                                  : Found::nothing;
  const auto record = stored_record(folder, unit.id);
  if (!record || !result_counts(folder, unit)) return Found::nothing;
  const bool any = record->problem.empty() && why_nothing_fitted(*record).empty();
  return any ? Found::result : Found::no_result;
}

}  // namespace

std::unordered_set<std::string> joined_stretches(const FleetPlan& plan,
                                                 const std::filesystem::path& folder) {
  std::unordered_set<std::string> out;
  for (const FleetUnit& unit : plan.units)
    if (unit.kind == UnitKind::join && has_result(folder, unit.id, false))
      out.insert(unit.parts.begin(), unit.parts.end());
  return out;
}

FleetStatus fleet_status(const FleetPlan& plan,
                         const std::filesystem::path& folder,
                         Progress& progress) {
  FleetStatus out;
  out.devices = plan.devices.size();
  out.units = plan.units.size();
  const std::unordered_set<std::string> joined = joined_stretches(plan, folder);
  for (std::size_t k = 0; k < plan.units.size(); ++k) {
    if (k % 256 == 0)
      progress.update(static_cast<double>(k) / static_cast<double>(out.units),
                      "looking at results");
    const FleetUnit& unit = plan.units[k];
    Found found = Found::nothing;
    try {
      found = joined.contains(unit.id) ? Found::result : look_at(unit, folder);
    } catch (const Error& error) {
      out.damaged.push_back(one_line(error.problem()));
      out.damaged_units.push_back(k);
    }
    if (found == Found::nothing) {
      out.missing.push_back(k);
      out.seconds_left += unit.cost.seconds;
    } else {
      ++out.done;
      if (found == Found::no_result) ++out.no_result;
    }
  }
  out.unpublished = unpublished(folder);
  return out;
}

}  // namespace libchar
