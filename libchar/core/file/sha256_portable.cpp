// SHA-256, FIPS 180-4, section 6.2. For each block of 16 words M, with W(t) = M(t) for t < 16, else
//   W(t) = s1(W(t-2)) + W(t-7) + s0(W(t-15)) + W(t-16)                       (1)
// 64 rounds over the eight words a … h:
//   T1 = h + S1(e) + Ch(e, f, g) + K(t) + W(t), T2 = S0(a) + Maj(a, b, c)    (2)
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "libchar/core/file/known_digest.hpp"
#include "libchar/core/file/sha256.hpp"

#if defined(__EMSCRIPTEN__)
#include <emscripten.h>
#include <stdlib.h>

// clang-format off: this is JavaScript
EM_JS(char*, page_known_digest, (const char* path), {
  const digest = Module.digests && Module.digests[UTF8ToString(path)];
  return digest ? allocateUTF8(digest) : 0;
});
// clang-format on
#endif

namespace libchar {
namespace {

using Words = std::array<std::uint32_t, 8>;
constexpr std::size_t kBlock = 64;

/// The first 32 bits of the fractional parts of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, 64> kRound = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

/// One word of each of four blocks: (1) depends on nothing before its block, so that vectors take four at once.
using Four [[gnu::vector_size(16)]] = std::uint32_t;
constexpr std::size_t kTogether = sizeof(Four) / sizeof(std::uint32_t);

template <class Word>
[[gnu::always_inline]] inline Word turned(Word x, int bits) {  // std::rotr takes no vectors
  return x >> bits | x << (32 - bits);
}

[[gnu::always_inline]] inline Four big_endian(Four word) {
  if (std::endian::native == std::endian::big) return word;
  return (turned(word, 8) & 0xFF00FF00U) | (turned(word, 24) & 0x00FF00FFU);
}

/// A round (2): of the eight words two change, which are d and h here. S1(e) is e ^ e>>>5 ^ e>>>19, turned by 6.
[[gnu::always_inline]] inline void round(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t& d,
                                         std::uint32_t e, std::uint32_t f, std::uint32_t g, std::uint32_t& h,
                                         std::uint32_t k_and_w) {
  const std::uint32_t s1 = turned(turned(turned(e, 14) ^ e, 5) ^ e, 6);
  const std::uint32_t s0 = turned(turned(turned(a, 9) ^ a, 11) ^ a, 2);
  h += s1 + (g ^ (e & (f ^ g))) + k_and_w;
  d += h;
  h += s0 + ((a & b) + (c & (a ^ b)));
}

/// K(t) + W(t) of up to four blocks.
using Schedule = std::array<std::array<std::uint32_t, kTogether>, 64>;

void schedule(const char* blocks, std::size_t count, Schedule& out) {
  std::array<Four, 64> w;
  for (std::size_t t = 0; t < 16; ++t) {
    std::array<std::uint32_t, kTogether> words{};
    for (std::size_t i = 0; i < count; ++i) std::memcpy(&words[i], blocks + kBlock * i + 4 * t, 4);
    std::memcpy(&w[t], words.data(), sizeof(Four));
    w[t] = big_endian(w[t]);
  }
  for (std::size_t t = 16; t < 64; ++t) {  // (1)
    const Four x = w[t - 15], y = w[t - 2];
    const Four s0 = turned(x, 7) ^ turned(x, 18) ^ (x >> 3U), s1 = turned(y, 17) ^ turned(y, 19) ^ (y >> 10U);
    w[t] = s1 + w[t - 7] + s0 + w[t - 16];
  }
  for (std::size_t t = 0; t < 64; ++t) {
    const Four sum = w[t] + kRound[t];
    std::memcpy(out[t].data(), &sum, sizeof(Four));
  }
}

void add_blocks(const char* blocks, std::size_t count, Words& hash) {
  Schedule of;
  count == kTogether ? schedule(blocks, kTogether, of) : schedule(blocks, count, of);
  for (std::size_t i = 0; i < count; ++i) {
    auto [a, b, c, d, e, f, g, h] = hash;
    // (2), eight rounds a turn: after them each word is where it was, and none has been moved.
    for (std::size_t t = 0; t < 64; t += 8) {
      round(a, b, c, d, e, f, g, h, of[t][i]);
      round(h, a, b, c, d, e, f, g, of[t + 1][i]);
      round(g, h, a, b, c, d, e, f, of[t + 2][i]);
      round(f, g, h, a, b, c, d, e, of[t + 3][i]);
      round(e, f, g, h, a, b, c, d, of[t + 4][i]);
      round(d, e, f, g, h, a, b, c, of[t + 5][i]);
      round(c, d, e, f, g, h, a, b, of[t + 6][i]);
      round(b, c, d, e, f, g, h, a, of[t + 7][i]);
    }
    const Words more = {a, b, c, d, e, f, g, h};
    for (std::size_t k = 0; k < hash.size(); ++k) hash[k] += more[k];
  }
}

}  // namespace

struct Sha256::State {
  Words hash = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<char, kBlock> rest{};
  std::size_t held = 0;     // of rest
  std::uint64_t bytes = 0;  // so far
};

Sha256::Sha256() : state_(detail::hidden<State>()) {}

void Sha256::update(std::string_view bytes) {
  State& s = *state_;
  s.bytes += bytes.size();
  if (s.held > 0) {
    const std::size_t more = std::min(kBlock - s.held, bytes.size());
    std::memcpy(s.rest.data() + s.held, bytes.data(), more);
    bytes.remove_prefix(more);
    s.held += more;
    if (s.held < kBlock) return;
    add_blocks(s.rest.data(), 1, s.hash);
    s.held = 0;
  }
  while (bytes.size() >= kBlock) {
    const std::size_t count = std::min(kTogether, bytes.size() / kBlock);
    add_blocks(bytes.data(), count, s.hash);
    bytes.remove_prefix(count * kBlock);
  }
  if (!bytes.empty()) std::memcpy(s.rest.data(), bytes.data(), bytes.size());
  s.held = bytes.size();
}

// A one, zeros, and the number of bits as 64-bit big-endian at the end of a block (section 5.1.1).
std::string Sha256::finish() {
  State& s = *state_;
  const std::uint64_t bits = 8 * s.bytes;
  const std::size_t zeros = (2 * kBlock - 9 - s.held) % kBlock;
  std::string end = "\x80" + std::string(zeros, '\0');
  for (int shift = 56; shift >= 0; shift -= 8) end += static_cast<char>(bits >> shift & 0xFFU);
  update(end);
  std::string digits;
  for (const std::uint32_t word : s.hash) digits += fmt::format("{:08x}", word);
  return digits;
}

#if defined(__EMSCRIPTEN__)
std::string detail::known_digest(const std::string& path) {
  char* const text = page_known_digest(path.c_str());
  std::string digest = text != nullptr ? text : "";
  free(text);
  return digest;
}
#else
std::string detail::known_digest(const std::string&) { return ""; }
#endif

}  // namespace libchar
