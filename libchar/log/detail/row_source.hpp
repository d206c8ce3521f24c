#pragma once
// The contract between a format (detail/format.hpp) and the common part of reading (time base, channel
// selection, repairs, grid): a format delivers rows as the file has them, in blocks of columns.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

namespace detail {
inline constexpr std::size_t kMostChannels = 32768;  ///< of a log, each of which takes 4 kB and more
}

/// A block of consecutive rows as the file has them.
struct RowBlock {
  std::size_t rows = 0;
  std::vector<std::vector<double>>
      columns;                        ///< the selected value columns, at least `rows` values each; NaN = missing cell
  std::vector<std::int64_t> time_ns;  ///< stamps in ns, at least `rows` values; empty when there is no time column
  std::uint64_t first_line = 0;       ///< CSV: physical line of the first row (1-based); 0 for binary formats
  std::vector<std::uint32_t> line_offset;  ///< CSV: line of row i is first_line + line_offset[i]; empty = i
};

/// Rows of one kind after those of another, each with a time of its own.
struct SortedRows {
  std::string column, first;  ///< which says the kind, and of the first rows
};

/// A file opened by its format.
class RowSource {
 public:
  virtual ~RowSource() = default;
  /// Channels (selected ones, in file order), format name, dialect, guesses;
  /// time.column/unit/unit_guessed/rate_hz if the file says.
  virtual const LogInfo& info() const = 0;
  /// The next rows, false at the end. Findings found on the way are added to `warnings`.
  virtual bool next(RowBlock& block, Findings& warnings) = 0;
  /// Before the first `next`: only rows first … end-1 are to come, and nothing in front of them is read; columns of
  /// other channels are there and hold any numbers. False: rows of this format have no fixed places.
  virtual bool restrict_rows(std::uint64_t first, std::uint64_t end, ChannelRange channels) {
    static_cast<void>(first);
    static_cast<void>(end);
    static_cast<void>(channels);
    return false;
  }
  /// Where row i of `block` stands, for messages: "line 412" or "row 17 (byte 1024)".
  virtual std::string place(const RowBlock& block, std::size_t i, std::uint64_t rows_before) const = 0;
  /// The same for the front of an error: "FILE:412:1" or "FILE (row 17, byte 1024)".
  virtual std::string where(const RowBlock& block, std::size_t i, std::uint64_t rows_before) const {
    return info().file + " (" + place(block, i, rows_before) + ")";
  }
  /// The rows are those of several clocks: how many there are in a second may change.
  virtual bool several_clocks() const { return false; }
  /// Asked for when the time begins again: by what the rows are sorted.
  virtual std::optional<SortedRows> sorted_by() const { return std::nullopt; }
  /// Called once when reading ends (at the end of the file or of the window): warnings that need totals.
  virtual void finish(Findings& warnings) { static_cast<void>(warnings); }
  /// Bytes consumed and in total (0 when unknown), for progress.
  virtual std::uint64_t bytes_read() const = 0;
  virtual std::uint64_t bytes_total() const = 0;
  /// After the last block: SHA-256 of the file when asked for.
  virtual std::string sha256() = 0;
};

}  // namespace libchar
