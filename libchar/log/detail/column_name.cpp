#include "libchar/log/detail/column_name.hpp"

#include <fmt/format.h>

#include <optional>

#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

// A unit behind '_': one letter alone is a unit only where it has no other use (gyro_x keeps
// its x, o3_1 its 1).
std::optional<std::string> unit_suffix(std::string_view name, std::string_view suffix) {
  if (suffix.empty() || (suffix[0] >= '0' && suffix[0] <= '9') || suffix == "-")
    return std::nullopt;
  if (suffix.size() == 1 && suffix != "g" && suffix != "s" && suffix != "V" && suffix != "K") {
    const bool celsius =
        (suffix == "C" || suffix == "c") && ascii_lower(name).find("temp") != std::string::npos;
    return celsius ? std::optional<std::string>("degC") : std::nullopt;
  }
  if (suffix == "none" || suffix == "min" || suffix == "rad" || suffix == "bar" ||
      suffix == "volt") {
    if (suffix == "none" || suffix == "min") return std::nullopt;  // "speed_min" is a minimum
  }
  if (find_unit(suffix)) return std::string(suffix);
  // rad_s, m_s2, deg_s: '_' in place of '/'
  std::string spelled(suffix);
  if (const std::size_t low = spelled.find('_'); low != std::string::npos) {
    spelled[low] = '/';
    if (find_unit(spelled)) return spelled;
  }
  return std::nullopt;
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
    const std::size_t at = cell.rfind(open);
    if (at == std::string_view::npos || at == 0) continue;
    const std::string_view name = trimmed(cell.substr(0, at));
    const std::string_view unit = trimmed(cell.substr(at + 1, cell.size() - at - 2));
    // gyro(1), gyro(2): an index, not a unit
    const bool index = unit.find_first_not_of("0123456789") == std::string_view::npos;
    if (!name.empty() && !index && unit.size() <= 40 && unit.find('"') == std::string_view::npos)
      return {std::string(name), std::string(unit)};
  }
  for (std::size_t low = cell.find('_'); low != std::string_view::npos;
       low = cell.find('_', low + 1)) {
    if (low == 0) continue;
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
