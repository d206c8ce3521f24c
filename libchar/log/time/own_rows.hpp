#pragma once
// Rows without a value of any channel that is read, in a table of slow and fast channels (a temperature
// once a second in rows of 200 Hz): the slow channel has rows, and a clock, of its own.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "libchar/log/detail/row_source.hpp"

namespace libchar {

class OwnRows {
 public:
  /// Takes the next rows while nothing is decided; true once it is: by the first rows, or at the end of the log.
  bool decide(const RowBlock& rows);
  bool decided() const { return decided_; }
  void decide_at_end();
  /// The rows have a clock of their own: blank ones are to be left out.
  bool apart() const { return apart_; }

 private:
  void judge();
  std::vector<std::int64_t> kept_;  // stamps of rows with a value
  std::size_t rows_ = 0, behind_blank_ = 0;
  bool last_blank_ = false, decided_ = false, apart_ = false;
};

/// Takes the rows without a value out of the block, and says how many there were.
std::size_t leave_out_blank_rows(RowBlock& rows);

}  // namespace libchar
