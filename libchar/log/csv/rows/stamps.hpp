#pragma once
// Which columns of a CSV file are its stamps, and how they are written.

#include <functional>

#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/head/dialect.hpp"

namespace libchar::csv {

/// What is known of a table when its stamps are looked for.
struct StampStudy {
  const std::vector<Cells>& rows;  ///< the first ones
  const std::vector<ColumnKind>& kinds;
  NumberStyle style;
  std::optional<double> stated_rate_hz;
  std::optional<double> stated_tick_s;
  std::function<std::vector<Cells>(std::size_t column)>
      whole_head;  ///< the cells of a column as far as the head goes: what the first rows leave open
};

/// Fills the stamps of `dialect`, and what is known of the time base and guessed of it in `info`.
void choose_stamps(const StampStudy& study, const ReadOptions& options, Dialect& dialect, LogInfo& info);

/// A stamp of one part, in nanoseconds.
StampDefect read_part(std::string_view text, const StampPart& part, const Dialect& dialect, std::int64_t& out,
                      std::size_t& offset);

}  // namespace libchar::csv
