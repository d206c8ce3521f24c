#include "libchar/log/csv/unpacker.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/json_rows.hpp"
#include "libchar/log/csv/lvm_rows.hpp"
#include "libchar/log/csv/object_rows.hpp"
#include "libchar/log/csv/sentence_rows.hpp"
#include "libchar/log/csv/signs/signs.hpp"
#include "libchar_have.hpp"

#if LIBCHAR_HAVE_ZLIB
#include <zlib.h>
#endif
#if LIBCHAR_HAVE_ZSTD
#include <zstd.h>
#endif
#if LIBCHAR_HAVE_LZMA
#include <lzma.h>
#endif

namespace libchar::csv {
namespace {

constexpr std::size_t kStoredBlock = std::size_t{1} << 17U;

[[noreturn, maybe_unused]] void refuse_damage(const std::string& file, const std::string& what) {
  throw input_error("E0329", file)
      .says("the compressed data are damaged: " + what)
      .hint("copy the file again, or unpack what can be saved with the tool that packed it");
}

[[noreturn, maybe_unused]] void refuse_without_library(const std::string& file, const char* what, const char* tool) {
  throw input_error("E0330", file)
      .says(std::string("this build cannot unpack ") + what)
      .hint(std::string("unpack it first: ") + tool);
}

// What all have in common: the next stored bytes when those at hand are used up.
class StoredBytes {
 public:
  StoredBytes(std::function<std::size_t(char*, std::size_t)> stored, std::string file)
      : file_(std::move(file)), stored_(std::move(stored)), bytes_(kStoredBlock) {}
  bool more() {
    size_ = stored_(bytes_.data(), bytes_.size());
    return size_ > 0;
  }
  const char* data() const { return bytes_.data(); }
  std::size_t size() const { return size_; }
  const std::string& file() const { return file_; }

 private:
  std::string file_;
  std::function<std::size_t(char*, std::size_t)> stored_;
  std::vector<char> bytes_;
  std::size_t size_ = 0;
};

#if LIBCHAR_HAVE_ZLIB
class Gunzip final : public Unpacker {
 public:
  explicit Gunzip(StoredBytes stored) : stored_(std::move(stored)) {
    constexpr int kGzipWindow = 15 + 16;
    if (inflateInit2(&stream_, kGzipWindow) != Z_OK) throw std::bad_alloc();
  }
  Gunzip(const Gunzip&) = delete;
  Gunzip& operator=(const Gunzip&) = delete;
  ~Gunzip() override { inflateEnd(&stream_); }

  std::size_t read(char* to, std::size_t n) override {
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = static_cast<uInt>(std::min<std::size_t>(n, std::size_t{1} << 30U));
    const uInt wanted = stream_.avail_out;
    while (stream_.avail_out == wanted && !done_) {
      if (stream_.avail_in == 0) {
        if (!stored_.more()) {
          done_ = true;
          cut_ = !between_members_;
          break;
        }
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stored_.data()));
        stream_.avail_in = static_cast<uInt>(stored_.size());
      }
      if (between_members_ && *stream_.next_in == 0) {  // padding behind the last member
        ++stream_.next_in;
        --stream_.avail_in;
        continue;
      }
      between_members_ = false;
      const int status = inflate(&stream_, Z_NO_FLUSH);
      if (status == Z_STREAM_END) {
        between_members_ = true;
        inflateReset(&stream_);
      } else if (status != Z_OK && status != Z_BUF_ERROR) {
        refuse_damage(stored_.file(), stream_.msg != nullptr ? stream_.msg : "gzip");
      }
    }
    return wanted - stream_.avail_out;
  }
  bool cut() const override { return cut_; }

 private:
  StoredBytes stored_;
  z_stream stream_{};
  bool done_ = false, cut_ = false, between_members_ = false;
};
#endif

#if LIBCHAR_HAVE_ZSTD
class Unzstd final : public Unpacker {
 public:
  explicit Unzstd(StoredBytes stored) : stored_(std::move(stored)), stream_(ZSTD_createDStream()) {
    if (stream_ == nullptr) throw std::bad_alloc();
  }
  Unzstd(const Unzstd&) = delete;
  Unzstd& operator=(const Unzstd&) = delete;
  ~Unzstd() override { ZSTD_freeDStream(stream_); }

  std::size_t read(char* to, std::size_t n) override {
    ZSTD_outBuffer out{to, n, 0};
    while (out.pos == 0 && !done_) {
      if (in_.pos == in_.size && !full_) {  // what is left inside comes out first
        if (!stored_.more()) {
          done_ = true;
          cut_ = inside_;
          break;
        }
        in_ = {stored_.data(), stored_.size(), 0};
      }
      const std::size_t left = ZSTD_decompressStream(stream_, &out, &in_);
      if (ZSTD_isError(left) != 0) refuse_damage(stored_.file(), ZSTD_getErrorName(left));
      inside_ = left != 0;
      full_ = out.pos == out.size;
    }
    return out.pos;
  }
  bool cut() const override { return cut_; }

 private:
  StoredBytes stored_;
  ZSTD_DStream* stream_;
  ZSTD_inBuffer in_{nullptr, 0, 0};
  bool done_ = false, cut_ = false, inside_ = false, full_ = false;
};
#endif

#if LIBCHAR_HAVE_LZMA
class Unxz final : public Unpacker {
 public:
  explicit Unxz(StoredBytes stored) : stored_(std::move(stored)) {
    constexpr std::uint64_t kMostMemory = std::uint64_t{256} << 20U;
    if (lzma_stream_decoder(&stream_, kMostMemory, LZMA_CONCATENATED) != LZMA_OK) throw std::bad_alloc();
  }
  Unxz(const Unxz&) = delete;
  Unxz& operator=(const Unxz&) = delete;
  ~Unxz() override { lzma_end(&stream_); }

  std::size_t read(char* to, std::size_t n) override {
    stream_.next_out = reinterpret_cast<std::uint8_t*>(to);
    stream_.avail_out = n;
    while (stream_.avail_out == n && !done_) {
      if (stream_.avail_in == 0 && !ended_) {
        ended_ = !stored_.more();
        stream_.next_in = reinterpret_cast<const std::uint8_t*>(stored_.data());
        stream_.avail_in = stored_.size();
      }
      const lzma_ret status = lzma_code(&stream_, ended_ ? LZMA_FINISH : LZMA_RUN);
      if (status == LZMA_STREAM_END) {
        done_ = true;
      } else if (status == LZMA_BUF_ERROR && ended_) {
        done_ = cut_ = true;
      } else if (status == LZMA_MEMLIMIT_ERROR) {
        refuse_damage(stored_.file(), "unpacking would take more than 256 MiB");
      } else if (status != LZMA_OK && status != LZMA_BUF_ERROR) {
        refuse_damage(stored_.file(), "xz");
      }
    }
    return n - stream_.avail_out;
  }
  bool cut() const override { return cut_; }

 private:
  StoredBytes stored_;
  lzma_stream stream_ = LZMA_STREAM_INIT;
  bool done_ = false, cut_ = false, ended_ = false;
};
#endif

// Characters beyond 0xFFFF, of two units, stand in no table of numbers: each unit becomes '?'.
class FromUtf16 final : public DecodedText {
 public:
  FromUtf16(StoredBytes stored, bool big) : stored_(std::move(stored)), big_(big) {}

  bool cut() const override { return done_ && half_; }
  std::string_view what() const override { return "UTF-16"; }

 private:
  void decode() override {
    done_ = !stored_.more();
    for (std::size_t i = 0; !done_ && i < stored_.size(); ++i) {
      const auto byte = static_cast<unsigned char>(stored_.data()[i]);
      if (half_) {
        const std::uint32_t unit = big_ ? *half_ * 256U + byte : byte * 256U + *half_;
        const bool pair = unit >= 0xD800 && unit < 0xE000;
        if (unit != 0xFEFF) append_utf8(text_, pair ? '?' : unit);
        half_.reset();
      } else {
        half_ = byte;
      }
    }
  }

  StoredBytes stored_;
  std::optional<std::uint32_t> half_;
  bool big_ = false;
};

/// Text whose mark was lost: each second byte is zero, but for few signs, and none of the others.
Packing unmarked_utf16(std::string_view front) {
  constexpr std::size_t kFewest = 16;
  std::array<std::size_t, 2> zeros = {};
  for (std::size_t i = 0; i < front.size(); ++i) zeros[i % 2] += front[i] == '\0';
  const std::size_t most = front.size() / 2 - front.size() / 16;
  if (front.size() < kFewest || std::min(zeros[0], zeros[1]) > 0) return Packing::none;
  return zeros[1] >= most ? Packing::utf16le : zeros[0] >= most ? Packing::utf16be : Packing::none;
}

}  // namespace

Packing packing_of(std::string_view first_bytes) {
  if (first_bytes.starts_with("\x1F\x8B")) return Packing::gzip;
  if (first_bytes.starts_with("\x28\xB5\x2F\xFD")) return Packing::zstd;
  if (first_bytes.starts_with(std::string_view("\xFD"
                                               "7zXZ\0",
                                               6)))
    return Packing::xz;
  constexpr std::size_t kMark = 2;
  if (first_bytes.size() > kMark && first_bytes.substr(kMark, kMark) != std::string_view("\0\0", kMark)) {
    if (first_bytes.starts_with("\xFF\xFE")) return Packing::utf16le;
    if (first_bytes.starts_with("\xFE\xFF")) return Packing::utf16be;
  }
  if (const Packing utf16 = unmarked_utf16(first_bytes); utf16 != Packing::none) return utf16;
  if (is_lvm(first_bytes)) return Packing::lvm;
  if (is_sentences(first_bytes)) return Packing::sentences;
  if (is_echo(first_bytes)) return Packing::echo;
  if (in_apostrophes(first_bytes)) return Packing::apostrophes;
  if (is_json_rows(first_bytes)) return Packing::json;
  if (has_spread_dates(first_bytes)) return Packing::dates;
  if (has_tuples(first_bytes)) return Packing::tuples;
  return signs_of(first_bytes).any() ? Packing::signs : Packing::none;
}

std::unique_ptr<Unpacker> make_unpacker(Packing packing,
                                        [[maybe_unused]] std::function<std::size_t(char*, std::size_t)> stored,
                                        const std::string& file) {
  switch (packing) {
    case Packing::none:
      break;
    case Packing::utf16le:
    case Packing::utf16be:
      return std::make_unique<FromUtf16>(StoredBytes(std::move(stored), file), packing == Packing::utf16be);
    case Packing::json:
      return open_json_rows(std::move(stored), file);
    case Packing::sentences:
      return open_sentence_rows(std::move(stored), file);
    case Packing::echo:
      return open_echo_rows(std::move(stored), file);
    case Packing::apostrophes:
      return open_apostrophes(std::move(stored));
    case Packing::dates:
      return open_spread_dates(std::move(stored));
    case Packing::tuples:
      return open_tuples(std::move(stored));
    case Packing::signs:
      return open_signs(std::move(stored));
    case Packing::lvm:
      return open_lvm_rows(std::move(stored), file);
    case Packing::gzip:
#if LIBCHAR_HAVE_ZLIB
      return std::make_unique<Gunzip>(StoredBytes(std::move(stored), file));
#else
      refuse_without_library(file, "gzip (zlib was not there)", "gunzip");
#endif
    case Packing::zstd:
#if LIBCHAR_HAVE_ZSTD
      return std::make_unique<Unzstd>(StoredBytes(std::move(stored), file));
#else
      refuse_without_library(file, "zstd (libzstd was not there)", "unzstd");
#endif
    case Packing::xz:
#if LIBCHAR_HAVE_LZMA
      return std::make_unique<Unxz>(StoredBytes(std::move(stored), file));
#else
      refuse_without_library(file, "xz (liblzma was not there)", "unxz");
#endif
  }
  return nullptr;
}

}  // namespace libchar::csv
