#pragma once
// Blocks of one stream of samples that two stages want transformed, and one of them transforms. Welch's spectrum goes
// by halves of its segments. The fit wants the squared cosine transforms of just such blocks; they cost next to nothing
// in parallel with a Fourier transform of the same samples. The two do not know each other:
//
//   SharedBlocks blocks(length, taker);             // Taker: the stage that only wants the squares.
//   if (blocks.offer(samples, whole)) …             // The stage that transforms, block after block. True asks for the
//                                                   // squares, which it adds up.
//   blocks.close(rest, power);                      // At the end: samples after the last block, the sums.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace libchar {

/// A stage that gets every sample of a stream once and in order, some of them as blocks that somebody else transforms.
class BlockTaker {
 public:
  /// A whole block, without missing samples, whose squared orthonormal DCT-II somebody else adds up: true. False, and
  /// nothing taken, when another block is under way: then it has to be pushed.
  virtual bool take_block(std::span<const double> samples) = 0;
  /// Samples outside of every block; missing ones are NaN.
  virtual void push(std::span<const double> samples) = 0;
  /// The sums of c_k² over the blocks that were taken, k = 0 … length-1 (k = 0 is of no meaning); once, at the end.
  virtual void take_power(std::vector<double> power) = 0;

  virtual ~BlockTaker() = default;
};

class SharedBlocks {
 public:
  /// The taker must live as long, at the same place.
  SharedBlocks(std::uint64_t length, BlockTaker& taker) : length_(length), taker_(&taker) {}

  std::uint64_t length() const { return length_; }

  /// The next `length` samples, in which none is missing when they are `whole`. True: their squared transform is
  /// wanted.
  bool offer(std::span<const double> samples, bool whole) {
    if (whole && taker_->take_block(samples)) return true;
    taker_->push(samples);
    return false;
  }

  /// No more samples come than these, fewer than a block. `power`: sums over the blocks that were wanted.
  void close(std::span<const double> rest, std::vector<double> power) {
    taker_->push(rest);
    taker_->take_power(std::move(power));
  }

 private:
  std::uint64_t length_;
  BlockTaker* taker_;
};

}  // namespace libchar
