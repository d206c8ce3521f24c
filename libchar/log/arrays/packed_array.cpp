#include "libchar/log/arrays/packed_array.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/error.hpp"

namespace libchar {
namespace {

void check_crc(const BinaryFile& file, const PackedArray& array, std::uint32_t found) {
  if (!zlib_is_here() || !array.crc || *array.crc == found) return;
  throw Error(
      {ErrorKind::input,
       "E0462",
       fmt::format("{}, {}", file.path(), array.name),
       fmt::format("is damaged: its checksum is {:08x}, {:08x} was expected", found, *array.crc),
       "",
       "copy the file again"});
}

// To the end of what is packed, where the checksum is known.
void read_out(PackedBytes& bytes, std::uint64_t end) {
  std::vector<std::byte> piece(1U << 16U);
  while (bytes.position() < end) {
    const auto n =
        static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), end - bytes.position()));
    bytes.read(std::span(piece).first(n));
  }
}

// Row after row: one pass over the bytes.
class InterleavedCursor final : public ArrayCursor {
 public:
  InterleavedCursor(const BinaryFile& file,
                    const PackedArray& array,
                    const ArrayRows& rows,
                    const std::vector<std::uint64_t>& columns,
                    std::uint64_t& consumed)
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
  PlanarCursor(const BinaryFile& file,
               const PackedArray& array,
               const ArrayRows& rows,
               const std::vector<std::uint64_t>& columns,
               std::uint64_t& consumed)
      : rows_(rows.rows),
        to_the_end_(array.to_the_end),
        element_bytes_(array.element_bytes),
        consumed_(consumed) {
    if (array.crc && zlib_is_here()) {
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

std::unique_ptr<ArrayCursor> open_packed_array(const BinaryFile& file,
                                               const PackedArray& array,
                                               const ArrayRows& rows,
                                               const std::vector<std::uint64_t>& columns,
                                               std::uint64_t& consumed) {
  if (rows.planar) return std::make_unique<PlanarCursor>(file, array, rows, columns, consumed);
  return std::make_unique<InterleavedCursor>(file, array, rows, columns, consumed);
}

}  // namespace libchar
