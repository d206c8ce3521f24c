#pragma once
// The middle sample (the mean of the two middle ones): no model, and right while less than half of
// the channels are wrong.

#include <vector>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

struct Median {
  static constexpr Description description{.name = "median",
                                           .title = "Median",
                                           .source = "Tukey 1977",
                                           .complexity = "O(n)",
                                           .needs = {.accepts_missing = true}};
  explicit Median(const Array& array) : sorted_(static_cast<std::size_t>(array.channels)) {}
  Estimate step(const Sample& y);

 private:
  std::vector<double> sorted_;
};

}  // namespace libchar::fusion
