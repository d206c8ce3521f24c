#pragma once
// Lines of a CSV file to columns of numbers, one chunk of whole lines at a time, with an account of
// every byte and cell.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/detail/row_source.hpp"

namespace libchar::csv {

inline constexpr std::size_t kPadding = 64;  // readable bytes behind a chunk's text

/// A place inside a chunk.
struct Spot {
  std::uint64_t line = 0;    ///< lines before it in the chunk
  std::uint64_t column = 1;  ///< 1-based, in bytes
};

/// Cases of one kind of oddity, with the first three places.
struct Tally {
  std::uint64_t count = 0;
  std::vector<Spot> spots;
  void add(std::uint64_t line, std::uint64_t column) {
    ++count;
    if (spots.size() < 3) spots.push_back({line, column});
  }
};

struct RowProblem {
  Problem problem;  ///< without the place
  Spot spot;
  std::uint64_t byte = 0;  ///< in the chunk
};

/// Everything goes somewhere: bytes = row + blank + comment + repeated header; cells = values +
/// missing + rejected + unread.
struct Account {
  std::uint64_t filtered_bytes = 0;  ///< of rows that were not asked for, or dropped
  std::uint64_t bytes = 0, row_bytes = 0, blank_bytes = 0, comment_bytes = 0, header_bytes = 0;
  std::uint64_t cells = 0, values = 0, missing = 0, rejected = 0, unread = 0, stamps = 0;
  void add(const Account& other);
  bool balanced() const {
    return bytes == row_bytes + filtered_bytes + blank_bytes + comment_bytes + header_bytes &&
           cells == values + missing + rejected + unread + stamps;
  }
};

/// What to do with each column of the file.
struct Plan {
  const Dialect* dialect = nullptr;
  std::vector<int> target;  ///< per file column: index among the selected channels, kSkip or kTime
  std::size_t channels = 0;
  bool overflow_as_missing = false;
  bool skip_repeated_header = false;
  bool drop_bad_rows = false;
  bool several_clocks = false;  ///< some columns have stamps of their own
  std::string file;
  static constexpr int kSkip = -1, kTime = -2, kMoreTime = -3;
};

/// What is noted of rows as they are read, and taken back where one of them is dropped.
struct RowNotes {
  Tally infinite, overflow, too_small, missing;
  std::vector<std::uint64_t> missing_per_channel;
  std::vector<std::uint32_t> fractional;  ///< per channel: some value was not written as an integer
  std::uint64_t inexact_integers = 0;
  Account account;
};

struct ParsedChunk : RowNotes {
  RowBlock rows;
  std::vector<std::uint32_t> groups;  ///< of each row, where a column makes groups
  std::uint64_t filtered = 0;         ///< rows that were not asked for
  std::uint64_t lines = 0;            ///< line ends in the chunk (a last line without one counts)
  std::optional<RowProblem> problem;
  std::optional<RowProblem> footer;  ///< why the first line of words behind the last row is none: no problem at the end
  std::optional<Spot> unended;       ///< end of a last row that has no line end and may have been cut in its last cell
  std::optional<Spot> cut;           ///< of a last row that the end of the file cuts: left out
  Tally blank, comment, repeated, mixed_end, bad, footers;
};

/// Parses the lines in `text` (whole lines; the last may lack its line end at the end of the file). `text` must be
/// readable for kPadding bytes past its end. After a problem the rows before it are kept and the rest is not looked at.
void parse_rows(std::string_view text, const Plan& plan, ParsedChunk& out);

}  // namespace libchar::csv
