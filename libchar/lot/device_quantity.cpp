#include "libchar/lot/device_quantity.hpp"

#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"

namespace libchar {

DeviceQuantity quantity_of(Term term) {
  return static_cast<DeviceQuantity>(term);
}

std::optional<Term> term_of(DeviceQuantity quantity) {
  const auto at = static_cast<std::size_t>(quantity);
  return at < kTerms ? std::optional(static_cast<Term>(at)) : std::nullopt;
}

bool in_logarithm(DeviceQuantity quantity) {
  return quantity < DeviceQuantity::turn_on_bias;
}

std::string title_of(DeviceQuantity quantity) {
  if (const auto term = term_of(quantity)) return term_title(*term);
  switch (quantity) {
    case DeviceQuantity::gauss_markov_sigma:
      return "Gauss–Markov deviation";
    case DeviceQuantity::gauss_markov_time:
      return "Gauss–Markov time";
    case DeviceQuantity::turn_on_bias:
      return "Turn-on bias";
    default:
      return "Temperature coefficient";
  }
}

std::string unit_of(DeviceQuantity quantity, std::string_view channel_unit) {
  const std::string unit = channel_unit.empty() ? "U" : std::string(channel_unit);
  if (term_of(quantity)) return term_unit(name_of(quantity), unit);
  if (quantity == DeviceQuantity::gauss_markov_time) return "s";
  return quantity == DeviceQuantity::temperature_coefficient ? unit + "/K" : unit;
}

}  // namespace libchar
