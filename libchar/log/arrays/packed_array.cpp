#include "libchar/log/arrays/packed_array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "libchar/core/file/crc32.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar_have.hpp"
#if LIBCHAR_HAVE_ZLIB
#include <zlib.h>
#endif

namespace libchar {

void PackedBytes::refuse(std::string what) const {
  throw input_error("E0462", fmt::format("{}, {} (byte {})", file_.path(), name_,
                                         stretch_.first_byte + std::min(packed_, stretch_.packed_bytes)))
      .says(std::move(what))
      .hint("copy the file again");
}

#if LIBCHAR_HAVE_ZLIB

namespace {
constexpr bool kZlibIsHere = true;  // which inflates, and knows the checksum
constexpr std::size_t kPackedPiece = std::size_t{1} << 16U;
}  // namespace

struct PackedBytes::Inflater {
  z_stream stream{};
  bool ended = false;
  std::vector<std::byte> in = std::vector<std::byte>(kPackedPiece);
  explicit Inflater(Packing packing) {
    if (::inflateInit2(&stream, packing == Packing::zlib ? MAX_WBITS : -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { ::inflateEnd(&stream); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
};

PackedBytes::PackedBytes(const BinaryFile& file, PackedStretch stretch, std::string name)
    : file_(file), stretch_(stretch), name_(std::move(name)) {
  if (stretch_.packing != Packing::stored) inflater_ = std::make_unique<Inflater>(stretch_.packing);
}

bool PackedBytes::inflate_into(std::span<std::byte> to, bool may_end) {
  z_stream& z = inflater_->stream;
  z.next_out = reinterpret_cast<Bytef*>(to.data());
  z.avail_out = static_cast<uInt>(to.size());
  while (z.avail_out > 0) {
    if (inflater_->ended && may_end) return false;
    if (inflater_->ended) refuse("ends before its data do");
    if (z.avail_in == 0) {
      const auto n =
          static_cast<std::size_t>(std::min<std::uint64_t>(inflater_->in.size(), stretch_.packed_bytes - packed_));
      if (n == 0) refuse("ends before its data do");
      file_.read(stretch_.first_byte + packed_, std::span(inflater_->in).first(n));
      packed_ += n;
      z.next_in = reinterpret_cast<Bytef*>(inflater_->in.data());
      z.avail_in = static_cast<uInt>(n);
    }
    const int status = ::inflate(&z, Z_NO_FLUSH);
    inflater_->ended = status == Z_STREAM_END;
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    if (status != Z_OK && status != Z_STREAM_END)
      refuse(fmt::format("compressed data are broken ({})", z.msg != nullptr ? z.msg : "no deflate stream"));
  }
  return true;
}

void PackedBytes::drain() {
  if (!inflater_) return;
  std::vector<std::byte> away(kPackedPiece);
  while (inflate_into(away, true)) {
  }
}

#else  // without zlib

namespace {
constexpr bool kZlibIsHere = false;
}

struct PackedBytes::Inflater {};

PackedBytes::PackedBytes(const BinaryFile& file, PackedStretch stretch, std::string name)
    : file_(file), stretch_(stretch), name_(std::move(name)) {
  if (stretch_.packing == Packing::stored) return;
  throw input_error("E0467", fmt::format("{}, {}", file_.path(), name_))
      .says("is compressed, and this program was built without zlib")
      .hint("install zlib1g-dev and build again, or save it without compression");
}

bool PackedBytes::inflate_into(std::span<std::byte>, bool) { return false; }

void PackedBytes::drain() {}

#endif

PackedBytes::~PackedBytes() = default;

void PackedBytes::read(std::span<std::byte> to) {
  if (to.size() > stretch_.bytes - position_) refuse("is shorter than what it describes");
  constexpr std::size_t kMost = std::size_t{1} << 30U;  // zlib counts in 32 bits
  for (std::size_t done = 0; done < to.size();) {
    const std::span<std::byte> piece = to.subspan(done, std::min(kMost, to.size() - done));
    if (inflater_) {
      inflate_into(piece, false);
    } else {
      file_.read(stretch_.first_byte + position_ + done, piece);
      packed_ += piece.size();
    }
    crc_ = crc32_of(piece, crc_);
    done += piece.size();
  }
  position_ += to.size();
}

void PackedBytes::skip(std::uint64_t count) {
  if (count > stretch_.bytes - position_) refuse("is shorter than what it describes");
  if (!inflater_) {
    position_ += count;
    packed_ += count;
    return;
  }
  std::vector<std::byte> away(static_cast<std::size_t>(std::min<std::uint64_t>(count, 1U << 16U)));
  while (count > 0) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(count, away.size()));
    read(std::span(away).first(n));
    count -= n;
  }
}

namespace {

void check_crc(const BinaryFile& file, const PackedArray& array, std::uint32_t found) {
  if (!kZlibIsHere || !array.crc || *array.crc == found) return;
  throw input_error("E0462", fmt::format("{}, {}", file.path(), array.name))
      .says("is damaged: its checksum is {:08x}, {:08x} was expected", found, *array.crc)
      .hint("copy the file again");
}

// To the end of what is packed, where the checksum is known.
void read_out(PackedBytes& bytes, std::uint64_t end) {
  std::vector<std::byte> piece(1U << 16U);
  while (bytes.position() < end) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), end - bytes.position()));
    bytes.read(std::span(piece).first(n));
  }
}

// Row after row: one pass over the bytes.
class InterleavedCursor final : public ArrayCursor {
 public:
  InterleavedCursor(const BinaryFile& file, const PackedArray& array, const ArrayRows& rows,
                    const std::vector<std::uint64_t>& columns, std::uint64_t& consumed)
      : file_(file),
        array_(array),
        rows_(rows),
        columns_(columns),
        consumed_(consumed),
        bytes_(file, array.stretch, array.name) {
    std::vector<std::byte> front(static_cast<std::size_t>(array.data_byte));
    bytes_.read(front);
  }

  void next(std::size_t rows, std::vector<ArrayPiece>& pieces) override {
    const auto stride = static_cast<std::size_t>(rows_.columns * array_.element_bytes);
    const std::uint64_t before = bytes_.packed_position();
    block_.resize(rows * stride);
    bytes_.read(block_);
    row_ += rows;
    pieces.clear();
    for (const std::uint64_t column : columns_)
      pieces.push_back({block_.data() + column * array_.element_bytes, stride});
    if (row_ == rows_.rows) {
      read_out(bytes_, array_.stretch.bytes);
      check_crc(file_, array_, bytes_.crc());
      if (array_.to_the_end) bytes_.drain();
    }
    consumed_ += bytes_.packed_position() - before;
  }

 private:
  const BinaryFile& file_;
  PackedArray array_;
  ArrayRows rows_;
  std::vector<std::uint64_t> columns_;
  std::uint64_t& consumed_;
  PackedBytes bytes_;
  std::vector<std::byte> block_;
  std::uint64_t row_ = 0;
};

// Column after column: one pass over the bytes in front of each.
class PlanarCursor final : public ArrayCursor {
 public:
  PlanarCursor(const BinaryFile& file, const PackedArray& array, const ArrayRows& rows,
               const std::vector<std::uint64_t>& columns, std::uint64_t& consumed)
      : rows_(rows.rows), to_the_end_(array.to_the_end), element_bytes_(array.element_bytes), consumed_(consumed) {
    if (array.crc && kZlibIsHere) {
      PackedBytes all(file, array.stretch, array.name);
      read_out(all, array.stretch.bytes);
      check_crc(file, array, all.crc());
    }
    for (const std::uint64_t column : columns) {
      auto bytes = std::make_unique<PackedBytes>(file, array.stretch, array.name);
      bytes->skip(array.data_byte + column * rows.rows * array.element_bytes);
      columns_.emplace_back().bytes = std::move(bytes);
    }
  }

  void next(std::size_t rows, std::vector<ArrayPiece>& pieces) override {
    pieces.clear();
    for (Column& column : columns_) {
      const std::uint64_t before = column.bytes->packed_position();
      column.block.resize(rows * static_cast<std::size_t>(element_bytes_));
      column.bytes->read(column.block);
      consumed_ += column.bytes->packed_position() - before;
      pieces.push_back({column.block.data(), static_cast<std::size_t>(element_bytes_)});
    }
    row_ += rows;
    if (row_ == rows_ && to_the_end_) columns_.back().bytes->drain();
  }

 private:
  struct Column {
    std::unique_ptr<PackedBytes> bytes;
    std::vector<std::byte> block;
  };
  std::uint64_t rows_, row_ = 0;
  bool to_the_end_;
  std::uint64_t element_bytes_;
  std::uint64_t& consumed_;
  std::vector<Column> columns_;
};

}  // namespace

std::unique_ptr<ArrayCursor> open_packed_array(const BinaryFile& file, const PackedArray& array, const ArrayRows& rows,
                                               const std::vector<std::uint64_t>& columns, std::uint64_t& consumed) {
  if (rows.planar) return std::make_unique<PlanarCursor>(file, array, rows, columns, consumed);
  return std::make_unique<InterleavedCursor>(file, array, rows, columns, consumed);
}

}  // namespace libchar
