#pragma once
// The last stamps of rows without a gap between them: where the grid stands, whatever the last one alone says.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libchar/core/numeric/median.hpp"

namespace libchar {

/// Exact where the difference fits into 64 bits: stamps of today are 2^60 ns and more.
inline double step_between(std::int64_t from, std::int64_t to) {
  std::int64_t step = 0;
  return __builtin_sub_overflow(to, from, &step) ? static_cast<double>(to) - static_cast<double>(from)
                                                 : static_cast<double>(step);
}

class RecentStamps {
 public:
  void push(std::int64_t stamp) {
    stamps_[next_++ % kMost] = stamp;
    size_ = std::min(size_ + 1, kMost);
  }
  void push(const std::int64_t* stamps, std::size_t n) {
    for (std::size_t i = n - std::min(n, kMost); i < n; ++i) push(stamps[i]);
  }
  void clear() { size_ = 0; }
  /// By the median of all of them, how far the last one stands behind its place on a grid of that interval, ns.
  double last_late(double interval_ns) const {
    const std::int64_t last = stamps_[(next_ - 1) % kMost];
    std::vector<double> off;
    for (std::size_t back = 0; back < size_; ++back)
      off.push_back(step_between(stamps_[(next_ - 1 - back) % kMost], last) - static_cast<double>(back) * interval_ns);
    return off.empty() ? 0 : median_in_place(off, Middle::lower);
  }

 private:
  static constexpr std::size_t kMost = 8;
  std::array<std::int64_t, kMost> stamps_ = {};
  std::size_t next_ = kMost, size_ = 0;
};

/// The last first rows of packets, on the grid.
class PacketStarts {
 public:
  void push(std::int64_t index, std::int64_t stamp) {
    starts_[next_++ % kMost] = {index, stamp};
    size_ = std::min(size_ + 1, kMost);
  }
  bool any() const { return size_ > 0; }
  /// How much later than those a packet is that begins with this row, the median, ns.
  double late(std::int64_t index, std::int64_t stamp, double interval_ns) const {
    std::vector<double> all;
    for (std::size_t k = 0; k < size_; ++k)
      all.push_back(step_between(starts_[k].stamp, stamp) -
                    static_cast<double>(index - starts_[k].index) * interval_ns);
    return median_in_place(all, Middle::lower);
  }

 private:
  struct Start {
    std::int64_t index, stamp;
  };
  static constexpr std::size_t kMost = 8;
  std::array<Start, kMost> starts_ = {};
  std::size_t next_ = kMost, size_ = 0;
};

}  // namespace libchar
