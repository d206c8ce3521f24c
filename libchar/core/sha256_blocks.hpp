#pragma once
// SHA-256 of whole blocks (FIPS 180-4, 6.2) by the SHA instructions of the processor, in steps.
//
// The 64 rounds of a block are one chain, each waiting for the one before: a block takes as long as
// some 300 other instructions could run beside it, and leaves nearly all of the processor idle. A
// loop with work of its own that puts the sixteen steps of a block between the parts of that work
// therefore gets the shorter of the two nearly for nothing.

#include <cstddef>
#include <cstdint>

#include "libchar/core/processor.hpp"

#if defined(LIBCHAR_X86_64)
#include <immintrin.h>
#endif

namespace libchar {

/// Where a hash stands, and the bytes that it takes next. The eight words in the order of the
/// instructions: f e b a, h g d c.
struct Sha256Blocks {
  alignas(16) std::uint32_t feba[4] = {0x9b05688c, 0x510e527f, 0xbb67ae85, 0x6a09e667};
  alignas(16) std::uint32_t hgdc[4] = {0x5be0cd19, 0x1f83d9ab, 0xa54ff53a, 0x3c6ef372};
  const char* next = nullptr;
  const char* end = nullptr;
};

inline constexpr std::ptrdiff_t kSha256Block = 64;

#if defined(LIBCHAR_X86_64)

// AVX2 is named for the sake of the loops that these functions are built into.
#define LIBCHAR_SHA_TARGET target("sha,avx2,bmi,bmi2,popcnt")
#define LIBCHAR_SHA_INLINE __attribute__((LIBCHAR_SHA_TARGET, always_inline))

alignas(16) inline constexpr std::uint32_t kSha256Constants[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

/// The same in registers, for as long as a loop runs. Without `blocks` there is nothing to do.
class Sha256Lane {
 public:
  LIBCHAR_SHA_INLINE explicit Sha256Lane(Sha256Blocks* blocks) : blocks_(blocks) {
    if (blocks == nullptr) return;
    feba_ = _mm_load_si128(reinterpret_cast<const __m128i*>(blocks->feba));
    hgdc_ = _mm_load_si128(reinterpret_cast<const __m128i*>(blocks->hgdc));
    next_ = blocks->next;
    end_ = blocks->end;
  }
  /// Is a whole block left?
  LIBCHAR_SHA_INLINE bool any() const { return end_ - next_ >= kSha256Block; }
  /// Four rounds; steps 0 to 15 in their order are a block.
  LIBCHAR_SHA_INLINE void step(std::size_t index) {
    if (index == 0) begin_feba_ = feba_, begin_hgdc_ = hgdc_;
    __m128i& words = words_[index % 4];
    if (index < 4) {
      const __m128i big_endian = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
      const auto* const from = reinterpret_cast<const __m128i*>(next_ + 16 * index);
      words = _mm_shuffle_epi8(_mm_loadu_si128(from), big_endian);
    } else {  // the message schedule
      const __m128i last = words_[(index + 3) % 4];
      // What _mm_alignr_epi8 does, which GCC does not compile without optimization behind {fmt} (it leaves __OPTIMIZE__ defined).
      using Words [[gnu::vector_size(16)]] = std::uint32_t;
      const auto seventh = reinterpret_cast<__m128i>(
          __builtin_shufflevector(reinterpret_cast<Words>(words_[(index + 2) % 4]),
                                  reinterpret_cast<Words>(last),
                                  1,
                                  2,
                                  3,
                                  4));
      const __m128i sum =
          _mm_add_epi32(_mm_sha256msg1_epu32(words, words_[(index + 1) % 4]), seventh);
      words = _mm_sha256msg2_epu32(sum, last);
    }
    const auto* const constants = reinterpret_cast<const __m128i*>(kSha256Constants + 4 * index);
    const __m128i terms = _mm_add_epi32(words, _mm_load_si128(constants));
    hgdc_ = _mm_sha256rnds2_epu32(hgdc_, feba_, terms);
    feba_ = _mm_sha256rnds2_epu32(feba_, hgdc_, _mm_shuffle_epi32(terms, 0x0E));
    if (index != 15) return;
    feba_ = _mm_add_epi32(feba_, begin_feba_);
    hgdc_ = _mm_add_epi32(hgdc_, begin_hgdc_);
    next_ += kSha256Block;
  }
  LIBCHAR_SHA_INLINE void block() {
    step(0), step(1), step(2), step(3), step(4), step(5), step(6), step(7);
    step(8), step(9), step(10), step(11), step(12), step(13), step(14), step(15);
  }
  LIBCHAR_SHA_INLINE void put_back() const {
    if (blocks_ == nullptr) return;
    _mm_store_si128(reinterpret_cast<__m128i*>(blocks_->feba), feba_);
    _mm_store_si128(reinterpret_cast<__m128i*>(blocks_->hgdc), hgdc_);
    blocks_->next = next_;
  }

 private:
  Sha256Blocks* blocks_;
  const char *next_ = nullptr, *end_ = nullptr;
  __m128i feba_{}, hgdc_{}, begin_feba_{}, begin_hgdc_{}, words_[4]{};
};

#endif

}  // namespace libchar
