#pragma once
// Long tables made wide: rows that say whose they are (sensor, time, x, y) become rows with the channels of all.

#include <cstdint>
#include <optional>
#include <vector>

#include "libchar/log/detail/row_source.hpp"

namespace libchar::csv {

/// Rows of one stamp become one row; with `cycles` a turn of all groups does, at the stamp of its first. What a group does not say
/// at a stamp is missing.
class Pivot {
 public:
  Pivot() = default;
  Pivot(std::size_t channels, std::size_t groups, bool timed, bool cycles);
  bool active() const { return groups_ > 0; }

  /// Replaces the rows of `block`, whose groups these are, by those that are complete.
  void widen(RowBlock& block, const std::vector<std::uint32_t>& groups);
  /// The last row, at the end of the file; false when there is none.
  bool flush(RowBlock& block);

 private:
  void begin(RowBlock& out);
  void emit(RowBlock& out);

  std::size_t channels_ = 0, groups_ = 0;
  bool timed_ = false, cycles_ = false, any_ = false;
  std::vector<double> values_;
  std::vector<bool> filled_;
  std::int64_t stamp_ = 0;
  std::uint64_t line_ = 0;
};

}  // namespace libchar::csv
