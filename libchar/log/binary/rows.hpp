#pragma once
// Rows of a binary file whose columns stand at constant strides: what .npy and raw files have in
// common. A format reads its header or sidecar into a BinaryLayout; everything after that is here.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libchar/log/binary/file.hpp"
#include "libchar/log/binary/number_type.hpp"
#include "libchar/log/detail/row_source.hpp"

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
  Findings warnings;
};

/// `info` brings format and dialect; channels, time column and warnings are filled in here.
std::unique_ptr<RowSource> open_binary_rows(std::unique_ptr<BinaryFile> file, BinaryLayout layout, LogInfo info,
                                            const ReadOptions& options);

}  // namespace libchar
