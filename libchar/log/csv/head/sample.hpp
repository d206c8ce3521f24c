#pragma once
// The first lines of a CSV file, from which its dialect is found out.

#include "libchar/log/csv/line.hpp"

namespace libchar::csv {

inline constexpr std::size_t kSample = 100;  ///< lines studied

struct Sample {
  std::vector<Line> lines;     ///< neither blank nor comments; the first may be a header of several physical lines
  std::vector<Line> comments;  ///< before the first of them
  std::vector<Line> later_comments;
  bool semicolon_comments = false;
};

/// The first kSample lines of `head` (all of the file when `whole`) from `offset` on, whose physical line has this
/// `number`. Throws Error(input) when not even the first line ends in the head.
Sample sample_lines(std::string_view head, bool whole, std::size_t offset, std::uint64_t number,
                    const std::string& file);

}  // namespace libchar::csv
