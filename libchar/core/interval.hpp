#pragma once
// An interval of numbers.

namespace libchar {

struct Interval {
  double low = 0, high = 0;
};

}  // namespace libchar
