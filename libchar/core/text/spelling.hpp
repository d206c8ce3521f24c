#pragma once
// Help with a word that is not known.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// The candidate nearest to `word` by edit distance, if it is near enough to be a slip (distance <=
/// 2, or <= a third of the word's length).
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates);

/// A hint: the nearest word, if there is one, else `otherwise`.
std::string did_you_mean(const std::optional<std::string>& near, std::string otherwise = "");

/// "a, b, c and 9 more": the first twelve names.
std::string first_names(const std::vector<std::string>& names);

/// Number of single-character edits (insert, delete, replace, swap of neighbours) between two words.
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace libchar
