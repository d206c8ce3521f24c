#pragma once
// Named points with intervals on one pair of logarithmic axes, and the front of those that nobody beats in both.

#include <string>

#include "libchar/benchmark/bench_view.hpp"

namespace libchar {

/// "<figure>…": names are escaped.
std::string svg_points(const BenchChart& chart, const std::string& title);

}  // namespace libchar
