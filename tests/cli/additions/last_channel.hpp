#pragma once
// The smallest fusion algorithm, for the test that it costs a file and a line: x is the last channel.

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

struct LastChannel {
  static constexpr Description description{
      .name = "last-channel", .title = "The last channel", .source = "a test", .complexity = "O(1)"};
  explicit LastChannel(const Array&) {}
  Estimate step(const Sample& y) const { return Estimate::scalar(y[y.size() - 1], std::nan("")); }
};

}  // namespace libchar::fusion
