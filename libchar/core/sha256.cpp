#include "libchar/core/sha256.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "libchar/core/sha256_blocks.hpp"

#if defined(LIBCHAR_X86_64)
#include <cpuid.h>
#endif

namespace libchar {
namespace {

constexpr std::size_t kBlock = kSha256Block;

#if defined(LIBCHAR_X86_64)

bool has_instructions() {
  static const bool has = [] {
    unsigned a = 0, b = 0, c = 0, d = 0;
    return __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (b & bit_SHA) != 0 &&
           __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
  }();
  return has;
}

// The SHA instructions leave the upper halves of the vector registers alone. Beside instructions that fill those halves, some processors
// save and restore them at every change: on an Intel Xeon a step of the hash takes 500 ns then, instead of 4, and a file is read at
// 7 MB/s. AMD's processors change for nothing.
bool mixes_with_wide_vectors() {
  return __builtin_cpu_is("amd");
}

__attribute__((LIBCHAR_SHA_TARGET)) void take_all(Sha256Blocks& blocks) {
  Sha256Lane lane(&blocks);
  while (lane.any()) lane.block();
  lane.put_back();
}

#else

bool has_instructions() {
  return false;
}
bool mixes_with_wide_vectors() {
  return false;
}
void take_all(Sha256Blocks&) {}

#endif

}  // namespace

struct Sha256::State {
  EVP_MD_CTX* context = nullptr;  // none: by instructions
  Sha256Blocks blocks;
  std::array<char, kBlock> pending{};  // the first `in_pending` bytes of a block
  std::size_t in_pending = 0;
  std::uint64_t length = 0;

  State() {
    if (has_instructions()) return;
    context = EVP_MD_CTX_new();
    EVP_DigestInit_ex(context, EVP_sha256(), nullptr);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { EVP_MD_CTX_free(context); }

  void take_pending() {
    blocks.next = pending.data();
    blocks.end = blocks.next + kBlock;
    take_all(blocks);
    in_pending = 0;
  }
  // The bit behind the message, zeros, and the number of its bits in the last eight bytes.
  void pad() {
    pending[in_pending++] = static_cast<char>(0x80);
    std::fill(pending.begin() + static_cast<std::ptrdiff_t>(in_pending), pending.end(), '\0');
    if (in_pending > kBlock - 8) {
      take_pending();
      pending.fill('\0');
    }
    const std::uint64_t bits = 8 * length;
    for (std::size_t i = 0; i < 8; ++i)
      pending[kBlock - 1 - i] = static_cast<char>(bits >> (8 * i) & 0xFFU);
    take_pending();
  }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

bool Sha256::can_interleave() const {
  return state_->context == nullptr && mixes_with_wide_vectors();
}

Sha256Blocks* Sha256::begin_interleaved(std::string_view bytes) {
  State& s = *state_;
  s.length += bytes.size();
  if (s.in_pending > 0) {
    const std::size_t more = std::min(kBlock - s.in_pending, bytes.size());
    std::copy_n(bytes.data(), more, s.pending.data() + s.in_pending);
    s.in_pending += more;
    bytes.remove_prefix(more);
    if (s.in_pending == kBlock) s.take_pending();
  }
  s.blocks.next = bytes.data();
  s.blocks.end = bytes.data() + bytes.size();
  return &s.blocks;
}

void Sha256::finish_interleaved() {
  State& s = *state_;
  take_all(s.blocks);
  const auto rest = static_cast<std::size_t>(s.blocks.end - s.blocks.next);
  if (rest == 0) return;  // nothing, or all of it went to what was pending
  std::copy_n(s.blocks.next, rest, s.pending.data());
  s.in_pending = rest;
  s.blocks.next = s.blocks.end;
}

void Sha256::update(std::string_view bytes) {
  if (state_->context != nullptr) {
    EVP_DigestUpdate(state_->context, bytes.data(), bytes.size());
    return;
  }
  begin_interleaved(bytes);
  finish_interleaved();
}

std::string Sha256::finish() {
  State& s = *state_;
  std::string text;
  if (s.context != nullptr) {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    EVP_DigestFinal_ex(s.context, digest, &size);
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }
  s.pad();
  const auto& [f, e, b, a] = s.blocks.feba;
  const auto& [h, g, d, c] = s.blocks.hgdc;
  for (const std::uint32_t word : {a, b, c, d, e, f, g, h}) text += fmt::format("{:08x}", word);
  return text;
}

}  // namespace libchar
