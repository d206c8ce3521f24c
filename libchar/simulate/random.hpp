#pragma once
// Random numbers that depend on nothing but a key and a position: the same on every machine, whatever the size of the
// blocks they are drawn in, the number of threads, and what other sensors draw.

#include <array>
#include <cstddef>
#include <cstdint>
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
  gauss_markov = 13,
  flicker_phase = 14,
  flicker_phase_start = 15,
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

/// Deviates of one stream. The deviate at a position depends on the key and the position alone, so
/// a stream may be entered anywhere. Every call of `normal` or `uniform` takes one position.
class DeviateStream {
 public:
  explicit DeviateStream(const StreamKey& key) : key_(key) {}
  /// Standard normal.
  double normal();
  void fill_normal(std::span<double> out);
  /// Uniform on [0, 1), a multiple of 2^-53.
  double uniform();
  /// Continues at this deviate; the stream begins at 0.
  void seek(std::uint64_t position);

 private:
  static constexpr std::size_t kWords = 64;
  void refill();
  StreamKey key_;
  std::uint64_t position_ = 0;
  bool filled_ = false;  ///< words_ holds the positions around position_
  std::array<std::uint64_t, kWords> words_;
};

}  // namespace libchar
