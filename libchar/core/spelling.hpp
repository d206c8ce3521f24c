#pragma once
// Help with a word that is not known.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// The candidate nearest to `word` by edit distance, if it is near enough to be a slip (distance <=
/// 2, or <= a third of the word's length).
std::optional<std::string> nearest(std::string_view word,
                                   const std::vector<std::string>& candidates);

/// Number of single-character edits (insert, delete, replace, swap of neighbours) between two
/// words.
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace libchar
