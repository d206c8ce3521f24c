#pragma once
// Rows of a binary file whose columns stand at constant strides: what .npy and raw files have in common. A format reads its
// header or sidecar into a BinaryLayout; everything after that is here.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/number_type.hpp"
#include "libchar/log/raw_rows.hpp"

namespace libchar {

struct BinaryColumn {
  std::string name;
  std::string unit;
  NumberFormat number;
  std::uint64_t first_byte = 0;  ///< of row 0, in the file
  std::uint64_t stride = 0;      ///< bytes from one row to the next
  double scale = 1, offset = 0;  ///< value = number * scale + offset
};

struct BinaryLayout {
  std::vector<BinaryColumn> columns;  ///< all of them, in file order
  std::uint64_t rows = 0;
  std::uint64_t data_byte = 0, data_bytes = 0;
  bool column_major = false;  ///< every column is one contiguous stretch
  bool named = false;         ///< names come from the file: a column named like time is the time column
  Warnings warnings;
};

/// A regular file opened for reading, with bounds: nothing is ever mapped (a file cut short by others would kill the process).
class BinaryFile {
 public:
  explicit BinaryFile(std::string path);
  ~BinaryFile();
  BinaryFile(const BinaryFile&) = delete;
  BinaryFile& operator=(const BinaryFile&) = delete;
  /// Fills `to` from `offset`. Throws Error(input) when the file ends before.
  void read(std::uint64_t offset, std::span<std::byte> to) const;
  /// The first `count` bytes, or all there are.
  std::string head(std::size_t count) const;
  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }

 private:
  std::string path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// `info` brings format and dialect; channels, time column and warnings are filled in here.
std::unique_ptr<RowSource> open_binary_rows(std::unique_ptr<BinaryFile> file, BinaryLayout layout, LogInfo info, const ReadOptions& options);

}  // namespace libchar
