#include "libchar/spectrum/spectrum_words.hpp"

#include <fmt/format.h>

#include <array>

#include "libchar/core/units.hpp"

namespace libchar {
namespace {

constexpr std::array<std::string_view, 2> kSquares = {"²", "^2"};

bool cut_end(std::string& text, std::string_view end) {
  if (!text.ends_with(end)) return false;
  text.resize(text.size() - end.size());
  return true;
}

std::string without_brackets(const std::string& text) {
  return text.size() > 1 && text.front() == '(' && text.back() == ')' ? text.substr(1, text.size() - 2) : text;
}

// "(deg/s)²", "g^2", "deg²/s²".
std::string root_of_unit(std::string text) {
  for (const std::string_view square : kSquares)
    if (cut_end(text, square)) break;
  if (find_unit(without_brackets(text))) return without_brackets(text);
  std::string bare = text;
  for (const std::string_view square : kSquares)
    for (std::size_t at = bare.find(square); at != std::string::npos; at = bare.find(square))
      bare.erase(at, square.size());
  return find_unit(bare) ? bare : without_brackets(text);
}

std::string known(std::string unit) { return unit == "U" ? "" : unit; }

}  // namespace

std::string spectrum_unit(Scaling scaling, const std::string& unit) {
  const std::string u = unit.empty() ? "U" : unit;
  const std::string bracketed = u.find_first_of("/ ²^") == std::string::npos ? u : "(" + u + ")";
  switch (scaling) {
    case Scaling::psd:
      return bracketed + "²/Hz";
    case Scaling::ps:
      return bracketed + "²";
    case Scaling::lsd:
      return bracketed + "/√Hz";
    case Scaling::ls:
      return u;
  }
  return u;
}

namespace detail {

SpectrumValues values_of_unit(std::string_view text) {
  std::string unit(text);
  if (unit.empty() || find_unit(unit)) return {Scaling::ls, unit};
  for (const std::string_view end : {"/√Hz", "/sqrt(Hz)", "/rtHz", "/Hz^0.5", "/Hz^(1/2)"})
    if (cut_end(unit, end)) return {Scaling::lsd, known(without_brackets(unit))};
  if (cut_end(unit, "/Hz")) return {Scaling::psd, known(root_of_unit(unit))};
  const bool square = unit.ends_with(kSquares[0]) || unit.ends_with(kSquares[1]);
  return {square ? Scaling::ps : Scaling::ls, known(square ? root_of_unit(unit) : unit)};
}

std::string spectrum_kind_word(SpectrumKind kind) {
  return fmt::format("{}_{}_sided", name_of(kind.scaling), name_of(kind.sides));
}

std::optional<SpectrumKind> spectrum_kind(std::string_view word) {
  for (const Sides sides : {Sides::one, Sides::two})
    for (const EnumWord<Scaling>& row : enum_table<Scaling>)
      if (word == spectrum_kind_word({row.value, sides})) return SpectrumKind{row.value, sides};
  return std::nullopt;
}

}  // namespace detail
}  // namespace libchar
