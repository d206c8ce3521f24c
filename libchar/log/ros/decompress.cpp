#include "libchar/log/ros/decompress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "libchar_have.hpp"
#if LIBCHAR_HAVE_LZ4
#include <lz4frame.h>
#endif
#if LIBCHAR_HAVE_ZSTD
#include <zstd.h>
#endif
#if LIBCHAR_HAVE_BZIP2
#include <bzlib.h>
#endif

#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

// Room behind what has come out so far: twice as much each time, so that a false size asks for nothing.
class Growing {
 public:
  Growing(std::vector<std::byte>& to, std::size_t packed, std::uint64_t most) : to_(to), most_(most) {
    to_.clear();
    step_ = std::max<std::size_t>(std::size_t{1} << 16U, 4 * packed);
  }
  ~Growing() { to_.resize(used_); }
  Growing(const Growing&) = delete;
  Growing& operator=(const Growing&) = delete;

  /// Where the next bytes go; empty when `most` have come.
  std::span<std::byte> room() {
    if (used_ == to_.size()) {
      const std::uint64_t wanted = used_ + std::max<std::uint64_t>(step_, used_);
      to_.resize(static_cast<std::size_t>(std::min(wanted, most_)));
    }
    return std::span(to_).subspan(used_);
  }
  void used(std::size_t bytes) { used_ += bytes; }

 private:
  std::vector<std::byte>& to_;
  std::uint64_t most_;
  std::size_t step_ = 0, used_ = 0;
};

constexpr const char* kTooMuch = "more comes out than was said";
constexpr const char* kCut = "ends in the middle";

#if LIBCHAR_HAVE_LZ4
std::string unpack_lz4(std::span<const std::byte> packed, Growing& out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) return "no memory for lz4";
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context,
                                                                                   &LZ4F_freeDecompressionContext);
  for (std::size_t at = 0;;) {
    const std::span<std::byte> room = out.room();
    std::size_t produced = room.size(), consumed = packed.size() - at;
    std::byte nowhere{};
    const std::size_t left = LZ4F_decompress(context, room.empty() ? &nowhere : room.data(), &produced,
                                             packed.data() + at, &consumed, nullptr);
    if (LZ4F_isError(left) != 0) return fmt::format("lz4: {}", LZ4F_getErrorName(left));
    out.used(produced);
    at += consumed;
    if (left == 0) return "";
    if (produced == 0 && consumed == 0) return room.empty() ? kTooMuch : kCut;
  }
}
#endif

#if LIBCHAR_HAVE_ZSTD
std::string unpack_zstd(std::span<const std::byte> packed, Growing& out) {
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(), &ZSTD_freeDStream);
  if (!stream) return "no memory for zstd";
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  for (;;) {
    const std::span<std::byte> room = out.room();
    std::byte nowhere{};
    ZSTD_outBuffer to{room.empty() ? &nowhere : room.data(), room.size(), 0};
    const std::size_t before = in.pos;
    const std::size_t left = ZSTD_decompressStream(stream.get(), &to, &in);
    if (ZSTD_isError(left) != 0) return fmt::format("zstd: {}", ZSTD_getErrorName(left));
    out.used(to.pos);
    if (left == 0) return "";
    if (to.pos == 0 && in.pos == before) return room.empty() ? kTooMuch : kCut;
  }
}
#endif

#if LIBCHAR_HAVE_BZIP2
std::string unpack_bz2(std::span<const std::byte> packed, Growing& out) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return "no memory for bz2";
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> owner(&stream, &BZ2_bzDecompressEnd);
  // bzlib takes no pointer to const; it reads only.
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));  // NOLINT(*const-cast)
  stream.avail_in = static_cast<unsigned>(packed.size());
  for (;;) {
    const std::span<std::byte> room = out.room();
    std::byte nowhere{};
    stream.next_out = reinterpret_cast<char*>(room.empty() ? &nowhere : room.data());
    stream.avail_out = static_cast<unsigned>(room.size());
    const unsigned before = stream.avail_in;
    const int code = BZ2_bzDecompress(&stream);
    const std::size_t produced = room.size() - stream.avail_out;
    out.used(produced);
    if (code == BZ_STREAM_END) return "";
    if (code != BZ_OK) return fmt::format("bz2: error {}", code);
    if (produced == 0 && stream.avail_in == before) return room.empty() ? kTooMuch : kCut;
  }
}
#endif

}  // namespace

std::string why_not_packed(std::string_view method) {
  if (method.empty() || method == "none") return "";
  const bool known = method == "lz4" || method == "zstd" || method == "bz2";
  const bool built = (method == "lz4" && LIBCHAR_HAVE_LZ4) || (method == "zstd" && LIBCHAR_HAVE_ZSTD) ||
                     (method == "bz2" && LIBCHAR_HAVE_BZIP2);
  if (built) return "";
  return known ? fmt::format("its chunks are packed with {0}, and this program is built without {0}", method)
               : fmt::format("its chunks are packed with \"{}\"; none, lz4, zstd and bz2 are read",
                             printable(method, 40));
}

std::string unpack([[maybe_unused]] std::string_view method, std::span<const std::byte> packed, std::uint64_t most,
                   std::vector<std::byte>& to) {
  Growing out(to, packed.size(), most);
#if LIBCHAR_HAVE_LZ4
  if (method == "lz4") return unpack_lz4(packed, out);
#endif
#if LIBCHAR_HAVE_ZSTD
  if (method == "zstd") return unpack_zstd(packed, out);
#endif
#if LIBCHAR_HAVE_BZIP2
  if (method == "bz2") return unpack_bz2(packed, out);
#endif
  return "cannot be unpacked";
}

}  // namespace libchar
