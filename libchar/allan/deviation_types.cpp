#include "libchar/allan/deviation_types.hpp"

#include <algorithm>

#include "libchar/core/units.hpp"

namespace libchar {
namespace {

using Type = DeviationType;
using Family = DeviationFamily;

constexpr std::uint64_t kSmallestTheo = 10, kSmallestBiasRemoved = 18;

// Rows of a program that adds its own (tests/cli/additions); their types follow those of the enumeration.
#ifndef LIBCHAR_MORE_DEVIATIONS
#define LIBCHAR_MORE_DEVIATIONS
#endif

// clang-format off
constexpr DeviationRow kRows[] = {
    // type        word       title                              order sum   div over  time  reflected
    {Type::adev,    "adev",    "Allan deviation",                  2, false, 2, false, false, false},
    {Type::oadev,   "oadev",   "Overlapping Allan deviation",      2, false, 2, true,  false, false},
    {Type::mdev,    "mdev",    "Modified Allan deviation",         3, true,  2, true,  false, false},
    {Type::tdev,    "tdev",    "Time deviation",                   3, true,  2, true,  true,  false},
    {Type::hdev,    "hdev",    "Hadamard deviation",               3, false, 6, false, false, false},
    {Type::ohdev,   "ohdev",   "Overlapping Hadamard deviation",   3, false, 6, true,  false, false},
    {Type::totdev,  "totdev",  "Total deviation",                  2, false, 2, true,  false, true},
    {Type::pdev,    "pdev",    "Parabolic deviation",              2, false, 2, true,  false, false, Family::parabola},
    {Type::mtotdev, "mtotdev", "Modified total deviation",         3, true,  2, true,  false, true,  Family::extended},
    {Type::ttotdev, "ttotdev", "Time total deviation",             3, true,  2, true,  true,  true,  Family::extended},
    {Type::htotdev, "htotdev", "Hadamard total deviation",         3, false, 6, true,  false, true,  Family::extended},
    {Type::theo1,   "theo1",   "Theo1",                            2, false, 1, true,  false, false, Family::theo},
    {Type::theobr,  "theobr",  "Theo1, bias removed",              2, false, 1, true,  false, false, Family::theo},
    {Type::theoh,   "theoh",   "TheoH (Allan and bias-removed Theo1)", 2, false, 1, true, false, false, Family::theo},
    {Type::mtie,    "mtie",    "Maximum time interval error",      1, false, 1, true,  true,  false, Family::interval},
    {Type::tierms,  "tierms",  "RMS time interval error",          1, false, 1, true,  true,  false, Family::interval},
    LIBCHAR_MORE_DEVIATIONS
};
// clang-format on

}  // namespace

std::uint64_t DeviationRow::span(std::uint64_t m) const {
  switch (family) {
    case Family::parabola:
      return 2 * m;
    case Family::extended:
      return 3 * m - (of_sum ? 1 : 0);
    case Family::theo:
      return std::max(m, type == Type::theo1 ? kSmallestTheo : kSmallestBiasRemoved);
    case Family::interval:
      return m;
    case Family::differences:
      break;
  }
  if (reflected) return m + 1;
  return static_cast<std::uint64_t>(order) * m - (of_sum ? 1 : 0);
}

std::span<const DeviationRow> deviation_rows() { return kRows; }

const DeviationRow& deviation_row(DeviationType type) { return kRows[static_cast<std::size_t>(type)]; }

std::string deviation_unit(DeviationType type, std::string_view unit) {
  const DeviationRow& row = deviation_row(type);
  if (!row.as_time && row.family != DeviationFamily::interval) return std::string(unit);
  if (unit.empty() || dimensionless(unit)) return "s";
  return unit.ends_with("/s") ? std::string(unit.substr(0, unit.size() - 2)) : std::string(unit) + "·s";
}

std::string_view name_of(DeviationType type) { return deviation_row(type).word; }

std::optional<DeviationType> deviation_type(std::string_view name) {
  for (const DeviationRow& row : kRows)
    if (row.word == name) return row.type;
  return std::nullopt;
}

std::vector<std::string> deviation_words() {
  std::vector<std::string> words;
  for (const DeviationRow& row : kRows) words.emplace_back(row.word);
  return words;
}

}  // namespace libchar
