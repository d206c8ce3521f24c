// The smallest fusion algorithm, for the test that it costs its files and a line: x is the last channel.
#include <cmath>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/entry.hpp"

namespace libchar::fusion {
namespace {

struct LastChannel {
  static constexpr Description description{.name = "last-channel",
                                           .title = "The last channel",
                                           .source = "a test",
                                           .complexity = "O(1)"};
  explicit LastChannel(const Array&) {}
  Estimate step(const Sample& y) const { return Estimate::scalar(y[y.size() - 1], std::nan("")); }
};

}  // namespace

Entry last_channel_algorithm() {
  return entry<LastChannel>();
}

}  // namespace libchar::fusion
