#include "libchar/log/detail/column_name.hpp"

#include <fmt/format.h>

#include <optional>

#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

// A unit behind '_': one letter alone is a unit only where it has no other use (gyro_x keeps its x, o3_1 its 1).
std::optional<std::string> unit_suffix(std::string_view name, std::string_view suffix) {
  if (suffix.empty() || (suffix[0] >= '0' && suffix[0] <= '9') || suffix == "-") return std::nullopt;
  if (suffix.size() == 1 && suffix != "g" && suffix != "s" && suffix != "V" && suffix != "K") {
    const bool celsius = (suffix == "C" || suffix == "c") && ascii_lower(name).find("temp") != std::string::npos;
    return celsius ? std::optional<std::string>("degC") : std::nullopt;
  }
  if (suffix == "none" || ascii_lower(suffix) == "min") return std::nullopt;  // "speed_min" is a minimum
  if (find_unit(suffix)) return std::string(suffix);
  // deg_per_s, m_per_s2
  std::string spelled(suffix);
  if (const std::size_t per = spelled.find("_per_"); per != std::string::npos) {
    spelled.replace(per, 5, "/");
    return find_unit(spelled) ? std::optional(spelled) : std::nullopt;
  }
  // rad_s, m_s2, deg_s: '_' in place of '/'
  if (const std::size_t low = spelled.find('_'); low != std::string::npos) {
    spelled[low] = '/';
    if (find_unit(spelled)) return spelled;
  }
  return std::nullopt;
}

// Where "[0]" begins at the end of a name, 0 when it does not end so.
std::size_t index_behind(std::string_view cell) {
  if (cell.size() < 4 || cell.back() != ']') return 0;
  const std::size_t open = cell.rfind('[');
  if (open == std::string_view::npos || open == 0 || open + 2 >= cell.size()) return 0;
  const std::string_view inside = cell.substr(open + 1, cell.size() - open - 2);
  return inside.find_first_not_of("0123456789") == std::string_view::npos ? open : 0;
}

// The one that the last sign of the cell closes: "a (m/(s^2))".
std::size_t opening_bracket(std::string_view cell, char open, char close) {
  for (std::size_t i = cell.size(), depth = 0; i-- > 0;) {
    depth += cell[i] == close ? 1 : 0;
    if (cell[i] == open && --depth == 0) return i;
  }
  return std::string_view::npos;
}

// "V(out)", "I(R1)" of SPICE: a voltage of a net, a current of a part; "V(mV)", "I(A)" have their unit in brackets.
std::string_view quantity_of_a_net(std::string_view cell) {
  constexpr std::size_t kLongest = 2;  // "mV"
  const bool voltage = cell.starts_with("V("), current = cell.starts_with("I(");
  if (!voltage && !current) return {};
  const std::string_view inside = cell.substr(2, cell.size() - 3);
  const bool unit = inside.size() <= kLongest && (inside.ends_with('V') || inside.ends_with('A'));
  if (unit || find_unit(inside) || inside.find_first_of("0123456789") == 0) return {};
  return voltage ? "V" : "A";
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::pair<std::string, std::string> name_and_unit(std::string_view column) {
  const std::string_view cell = trimmed(column);
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    if (cell.empty() || cell.back() != close) continue;
    const std::size_t at = opening_bracket(cell, open, close);
    if (at == std::string_view::npos || at == 0) continue;
    const std::string_view name = trimmed(cell.substr(0, at));
    std::string_view unit = trimmed(cell.substr(at + 1, cell.size() - at - 2));
    if (unit.empty() && !name.empty()) return {std::string(name), ""};
    if (unit.starts_with("in ") && find_unit(unit.substr(3))) unit = trimmed(unit.substr(3));
    if (const std::string_view of = quantity_of_a_net(cell); !of.empty()) return {std::string(cell), std::string(of)};
    // gyro(1), gyro(2): an index, not a unit
    const bool index = unit.find_first_not_of("0123456789") == std::string_view::npos;
    // "Temp, °C (serial 10012345)" has its unit in front of a remark.
    const std::size_t comma = name.rfind(", ");
    if (!find_unit(unit) && comma != std::string_view::npos && comma > 0 && find_unit(trimmed(name.substr(comma + 2))))
      return {std::string(trimmed(name.substr(0, comma))), std::string(trimmed(name.substr(comma + 2)))};
    if (unit.find(": ") != std::string_view::npos) return {std::string(name), ""};
    if (!name.empty() && !index && unit.size() <= 40 && unit.find('"') == std::string_view::npos)
      return {std::string(name), std::string(unit)};
  }
  // "Pressure, hPa", "EMG,uV", "Time since start in ms", "Temperatur °C", but not "gyro x g", whose g may be an axis.
  for (const std::string_view sign : {std::string_view(","), std::string_view(" in "), std::string_view(" ")})
    if (const std::size_t at = cell.rfind(sign); at != std::string_view::npos && at > 0)
      if (const std::string_view unit = trimmed(cell.substr(at + sign.size()));
          find_unit(unit) && (sign != " " || unit.find_first_of("/%^\xC2") != std::string_view::npos))
        return {std::string(trimmed(cell.substr(0, at))), std::string(unit)};
  // "gyro_rad[0]": an index behind the unit. PX4 calls rates of turn rad.
  if (const std::size_t index = index_behind(cell); index > 0) {
    auto [name, unit] = name_and_unit(cell.substr(0, index));
    if (unit == "rad" && ascii_lower(name).find("gyro") != std::string::npos) unit = "rad/s";
    if (unit == "ga") unit = "Gauss";
    if (!unit.empty()) return {name + std::string(cell.substr(index)), unit};
  }
  for (std::size_t low = cell.find('_'); low != std::string_view::npos; low = cell.find('_', low + 1)) {
    if (low == 0 || cell.substr(0, low).ends_with("_per") || cell.substr(0, low).ends_with("_of")) continue;
    if (const auto unit = unit_suffix(cell.substr(0, low), cell.substr(low + 1)))
      return {std::string(cell.substr(0, low)), *unit};
  }
  return {std::string(cell), ""};
}

bool unnamed(const std::vector<Channel>& channels) {
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (channels[i].name != fmt::format("c{}", i)) return false;
  return true;
}

}  // namespace libchar
