#pragma once
// Numbers of one type to a file, row by row or column by column.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/log/binary/number_type.hpp"

namespace libchar {

/// Numbers of one type, row by row or column by column. Columns of unknown length are kept in a
/// nameless file in the target's folder until their end is known.
class ValueWriter {
 public:
  ValueWriter(WholeFile& file, std::size_t channels, NumberFormat number, bool column_major);
  ~ValueWriter();
  ValueWriter(const ValueWriter&) = delete;
  ValueWriter& operator=(const ValueWriter&) = delete;
  void write(std::span<const std::span<const double>> columns);
  /// Puts the columns one behind the other (nothing to do row by row).
  void finish();
  std::uint64_t rows() const { return rows_; }
  std::uint64_t rounded() const { return rounded_; }  ///< values that 32 bits cannot hold exactly

 private:
  void encode(double value, std::byte* to);
  void spill();
  [[noreturn]] void fail(const char* doing) const;

  WholeFile& file_;
  NumberFormat number_;
  bool column_major_;
  int spool_ = -1;
  std::uint64_t rows_ = 0, rounded_ = 0;
  std::vector<std::byte> bytes_;                 // row by row: the block being encoded
  std::vector<std::vector<std::byte>> pending_;  // column by column: encoded, not yet in the spool
  std::vector<std::uint64_t> stretch_bytes_;     // length of each stretch in the spool; one stretch a column and spill
};

}  // namespace libchar
