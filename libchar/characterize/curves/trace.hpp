#pragma once
// A record small enough to be drawn: the least and the largest value of each of a few hundred blocks, in one pass and constant memory.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libchar/core/numeric/halving.hpp"

namespace libchar {

struct Trace {
  std::uint64_t block = 1;  ///< samples in each
  /// Of each block, from the record's first sample on; NaN where all of it is missing. The last may be shorter.
  std::vector<double> low, high;
  std::vector<std::uint64_t> missing;  ///< samples of each
};

/// Takes a record in pieces of any size. Blocks have a power of two of samples, so that 400 to 800 hold any record longer than that.
class TraceMeter {
 public:
  void push(std::span<const double> samples) { all_.push(samples); }
  Trace finish() const;
  std::uint64_t samples() const { return all_.samples(); }
  void join(TraceMeter later) { all_.join(std::move(later.all_)); }
  void write_state(StateWriter& to) const { all_.write_state(to); }
  void read_state(StateReader& from) { all_.read_state(from, "the trace of a channel"); }

 private:
  struct Block {
    double low = __builtin_inf(), high = -__builtin_inf();
    std::uint64_t missing = 0;
    void take(std::span<const double> samples);
    void join(const Block& later);
    static void layout(auto& at, auto& block) { at(block.low, block.high, block.missing); }
  };

  detail::Halving<Block, 800> all_;
};

}  // namespace libchar
