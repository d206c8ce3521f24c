#pragma once
// What an algorithm asks for and how it was set, in words.

#include <string>
#include <vector>

#include "libchar/fusion/registry.hpp"

namespace libchar {

/// What an algorithm asks of a scene, a phrase each; empty: nothing beyond the samples.
std::vector<std::string> needs_in_words(const fusion::Description& description);

/// Options that differ from the table's standard, "gamma = 0.99".
std::string settings_in_words(const fusion::Settings& settings);

}  // namespace libchar
