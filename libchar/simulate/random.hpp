#pragma once
// Random numbers that depend on nothing but a key and a position: the same on every machine,
// whatever the size of the blocks they are drawn in, the number of threads, and what other sensors
// draw.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace libchar {

/// What a stream of deviates is for; every use has a stream of its own. The numbers are part of
/// what a seed means: append, never renumber.
enum class Purpose : std::uint64_t {
  white = 0,
  white_start = 1,
  flicker = 2,
  flicker_start = 3,
  walk = 4,
  quantization = 5,
  scale_draw = 6,
  bias_draw = 7,
  truth = 8,
  temperature = 9,
  fault = 10,
  low_pass_start = 11,
  bootstrap = 12,
};

/// Names one stream. Streams of different keys are independent: seed and sensor are the key of the
/// generator, the purpose is a word of its counter, so no two streams ever share a block.
struct StreamKey {
  std::uint64_t seed = 0;
  std::uint64_t sensor = 0;
  Purpose purpose = Purpose::white;
};

/// Philox4x64-10 (Salmon et al., SC 2011): 256 bits that are a function of counter and key.
std::array<std::uint64_t, 4> philox(const std::array<std::uint64_t, 4>& counter,
                                    const std::array<std::uint64_t, 2>& key);

/// The 64-bit words of one stream in order; satisfies std::uniform_random_bit_generator.
class BitStream {
 public:
  using result_type = std::uint64_t;
  explicit BitStream(const StreamKey& key) : key_(key) {}
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()() {
    if (next_ == words_.size()) refill();
    return words_[next_++];
  }

 private:
  void refill();
  static constexpr std::size_t kWords = 64;
  StreamKey key_;
  std::uint64_t block_ = 0;  ///< counter of the next 256 bits
  std::size_t next_ = kWords;
  std::array<std::uint64_t, kWords> words_;
};

/// Deviates of one stream, one after the other. A normal deviate takes a random number of words
/// (1.01 on average), so a stream is drawn from its start, block by block.
class DeviateStream {
 public:
  explicit DeviateStream(const StreamKey& key) : bits_(key) {}
  /// Standard normal deviates.
  double normal();
  void fill_normal(std::span<double> out);
  /// Uniform on [0, 1): the upper 53 bits of a word.
  double uniform() { return static_cast<double>(bits_() >> 11U) * 0x1.0p-53; }

 private:
  BitStream bits_;
};

}  // namespace libchar
