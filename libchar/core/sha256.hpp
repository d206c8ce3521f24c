#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace libchar {

struct Sha256Blocks;

/// SHA-256 of a stream of bytes (the same digest as sha256sum prints): by the SHA instructions of
/// the processor, where it has them, else by OpenSSL.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;
  void update(std::string_view bytes);
  /// Does it pay for another loop to hash blocks beside its own work (sha256_blocks.hpp)? Only on processors that mix these
  /// instructions with AVX freely.
  bool can_interleave() const;
  /// The stream's next bytes, for such a loop: it takes as many of the whole blocks as it likes,
  /// and `finish_interleaved` the rest. The bytes must stay where they are until then. Only where
  /// `can_interleave()`.
  Sha256Blocks* begin_interleaved(std::string_view bytes);
  void finish_interleaved();
  /// 64 lower-case hexadecimal digits. Ends the stream.
  std::string finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace libchar
