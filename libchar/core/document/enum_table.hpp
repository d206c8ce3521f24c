#pragma once
// The words of enums, one table each: what the command line offers, what YAML and JSON hold, and
// what messages list. A table is next to its enum:
//
//     enum class Sides { one, two };
//     template <>
//     inline constexpr auto enum_table<Sides> = enum_words<Sides, "one two">;
//
// Words in another order than the enum's, or with blanks in them, are next to their values:
//
//     std::to_array<EnumWord<Sides>>({{Sides::two, "two"}, {Sides::one, "one"}})

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace libchar {

template <typename Enum>
struct EnumWord {
  Enum value;
  std::string_view word;
};

namespace detail {

/// Words with blanks between them, as an argument of a template.
template <std::size_t N>
struct WordList {
  char text[N] = {};
  constexpr WordList(const char (&words)[N]) { std::copy_n(words, N, text); }
};

}  // namespace detail

/// The words of an enum that counts from 0, in its order.
template <typename Enum, detail::WordList words>
inline constexpr auto enum_words = [] {
  constexpr std::string_view all(words.text);
  std::array<EnumWord<Enum>, std::count(all.begin(), all.end(), ' ') + 1> rows{};
  for (std::size_t i = 0, from = 0; i < rows.size(); ++i) {
    const std::string_view rest = all.substr(from);  // gcc's sanitizers take no `find` of a text for a constant
    const auto length = static_cast<std::size_t>(std::find(rest.begin(), rest.end(), ' ') - rest.begin());
    rows[i] = {static_cast<Enum>(i), rest.substr(0, length)};
    from += length + 1;
  }
  return rows;
}();

/// The table of an enum, in the order in which its words are offered; nullptr for one without.
template <typename Enum>
inline constexpr std::nullptr_t enum_table = nullptr;

template <typename Enum>
concept EnumWithTable = std::is_enum_v<Enum> && requires {
  enum_table<Enum>.size();
};

/// The word of a value, "" when the table has none.
template <EnumWithTable Enum>
constexpr std::string_view name_of(Enum value) {
  for (const EnumWord<Enum>& row : enum_table<Enum>)
    if (row.value == value) return row.word;
  return "";
}

/// The value of a word, nothing when no row has it.
template <EnumWithTable Enum>
constexpr std::optional<Enum> find_enum(std::string_view word) {
  for (const EnumWord<Enum>& row : enum_table<Enum>)
    if (row.word == word) return row.value;
  return std::nullopt;
}

/// All words, in order.
template <EnumWithTable Enum>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  words.reserve(enum_table<Enum>.size());
  for (const EnumWord<Enum>& row : enum_table<Enum>) words.emplace_back(row.word);
  return words;
}

}  // namespace libchar
