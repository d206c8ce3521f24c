#pragma once
// Text that is not stored as UTF-8, made so as a stream in constant memory: compressed by gzip (RFC 1952, several
// members), Zstandard (RFC 8878, several frames) or xz, or written in UTF-16 behind its mark (Excel's "Unicode Text").
// The libraries are zlib, libzstd and liblzma; a build without one of them says so.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "libchar/core/finding.hpp"

namespace libchar::csv {

enum class Packing {
  none,
  gzip,
  zstd,
  xz,
  utf16le,
  utf16be,
  json,
  lvm,
  sentences,
  echo,
  apostrophes,
  signs,
  dates,
  tuples
};

/// By the first bytes.
Packing packing_of(std::string_view first_bytes);
inline constexpr std::size_t kPackingBytes = 1024;  ///< that it looks at

class Unpacker {
 public:
  virtual ~Unpacker() = default;
  /// Up to n bytes, 0 at the end. Throws Error(input) for damaged data.
  virtual std::size_t read(char* to, std::size_t n) = 0;
  /// The stored data ended before their end mark.
  virtual bool cut() const = 0;
  virtual std::string_view what() const { return "compressed"; }
  /// Is the text made by this program, with commas, points and, if so, a header?
  virtual bool made() const { return false; }
  virtual bool headed() const { return made(); }
  /// What a row of such a text was in the file.
  virtual std::string_view row_name() const { return "row"; }
  /// In the table of formats.
  virtual std::string_view format() const { return "csv"; }
  /// Bytes that the text is made of; 0: those that `stored` gave.
  virtual std::uint64_t stored_bytes() const { return 0; }
  virtual void finish(Findings& findings) const { static_cast<void>(findings); }
};

/// Text that is decoded a piece at a time.
class DecodedText : public Unpacker {
 public:
  std::size_t read(char* to, std::size_t n) final {
    while (text_.empty() && !done_) decode();
    const std::size_t taken = text_.copy(to, n);
    text_.erase(0, taken);
    return taken;
  }
  bool cut() const override { return false; }

 protected:
  virtual void decode() = 0;  ///< appends to `text_`, or is done
  std::string text_;
  bool done_ = false;
};

/// Is text of so many bytes more than a file of measurements would be when packed into so few? Small ones are free.
inline bool is_bomb(std::uint64_t text, std::uint64_t stored, std::uint64_t most) {
  constexpr std::uint64_t kFree = std::uint64_t{32} << 20U;
  return text > kFree && text / most > stored;
}
inline constexpr std::uint64_t kMostPacked = 100;  ///< times
inline constexpr std::uint64_t kMostMade = 32;     ///< times, of text with empty cells for what is not there

/// `stored` gives the file's bytes, 0 at its end. Throws Error(input) where this build lacks the library.
std::unique_ptr<Unpacker> make_unpacker(Packing packing, std::function<std::size_t(char*, std::size_t)> stored,
                                        const std::string& file);

}  // namespace libchar::csv
