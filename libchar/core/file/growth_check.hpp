#pragma once
// Checks such as a build server asks for: "rmse+5%", "gyro_x:white_noise+10%": how much a number may have grown.

#include <string>
#include <string_view>
#include <vector>

namespace libchar {

struct GrowthCheck {
  std::string text;    ///< as it was typed
  std::string label;   ///< of one; empty: of every one
  std::string metric;  ///< one of the words that may grow
  double share = 0;    ///< by which it may be larger
};

/// What a check may say.
struct GrowthWords {
  std::vector<std::string> metrics;
  std::string labelled;  ///< what a label is of: "algorithm"
  std::string example;   ///< "such as rmse+5%, or minque:regret+0.5%"
};

/// "[LABEL:]METRIC+NUMBER%". Throws Error(usage) with the nearest metric.
GrowthCheck parse_growth_check(std::string_view text, const GrowthWords& words);

/// A check that says no more than it may. Throws Error(usage).
[[noreturn]] void refuse_check(std::string_view text, const std::string& what, const std::string& hint);

}  // namespace libchar
