#include "libchar/export/consumers.hpp"

#include <optional>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/units.hpp"
#include "libchar/export/detail/consumer_rows.hpp"

namespace libchar {
namespace {

// A coefficient raised to a power and converted; a limit stays a limit.
std::string converted(const Coefficient& c, double factor, int power) {
  if (power == 1) return value_text(c, factor);
  if (c.value) return number_text(*c.value * *c.value * factor, 4);
  if (c.upper95) return "≤ " + number_text(*c.upper95 * *c.upper95 * factor, 3);
  return "–";
}

std::string_view sensor_in(const std::optional<Unit>& unit) {
  if (unit && unit->quantity == Quantity::angular_rate) return "gyroscope";
  if (unit && unit->quantity == Quantity::acceleration) return "accelerometer";
  return "other";
}

// "U/√Hz" in the channel's own unit, which may be unknown.
std::string unit_of(const ConsumerRow& row, const std::string& own) {
  const bool in_own = row.unit.starts_with('U') && !own.empty();
  return in_own ? own + std::string(row.unit.substr(1)) : std::string(row.unit);
}

}  // namespace

std::vector<ConsumerNumber> consumer_numbers(const Coefficients& coefficients,
                                             const std::string& unit,
                                             double rate_hz) {
  const auto known = find_unit(unit);
  const std::string_view sensor = sensor_in(known);
  const RowTimes times{.rate_hz = rate_hz};
  std::vector<ConsumerNumber> out;
  for (const ConsumerRow& row : consumer_table()) {
    const bool any = row.sensor.empty();
    const Coefficient& c = coefficients[static_cast<std::size_t>(row.term)];
    if (!row.in_report || (!any && row.sensor != sensor) || (!c.value && !c.upper95)) continue;
    const double si = any || sensor == "other" ? 1 : known->to_si;
    const double factor = (row.power == 2 ? si * si : si) * row.factor(times);
    out.push_back({std::string(row.consumer),
                   std::string(row.key),
                   std::string(row.formula),
                   converted(c, factor, row.power),
                   unit_of(row, unit)});
  }
  return out;
}

}  // namespace libchar
