#pragma once
// A record small enough to be drawn: the least and the largest value of each of a few hundred blocks, in one pass and constant memory.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/numeric/state_archive.hpp"

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
  void push(std::span<const double> samples);
  Trace finish() const;
  std::uint64_t samples() const { return blocks_.size() * length_ + filled_; }

  /// The samples that `later` has seen follow directly: the same as if they had been pushed here. They must be at most the largest power of two that
  /// divides the number of those before: else std::logic_error.
  void join(TraceMeter later);
  void write_state(StateWriter& to) const;
  void read_state(StateReader& from);

 private:
  struct Block {
    double low = __builtin_inf(), high = -__builtin_inf();
    std::uint64_t missing = 0;
    void take(const double* samples, std::size_t count);
    void join(const Block& later);
  };
  void close();
  void halve();

  std::uint64_t length_ = 1;  ///< of a block
  std::uint64_t filled_ = 0;  ///< samples in the block that is open
  Block open_;
  std::vector<Block> blocks_;
};

}  // namespace libchar
