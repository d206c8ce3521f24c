#pragma once
// Tables in long form, whose rows say whose they are: found, and told apart by options.

#include <functional>
#include <optional>

#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/detail/row_source.hpp"

namespace libchar::csv {

/// The filters of options.kinds.where. Throws Error(usage) for a column that is not there or a word without '='.
std::vector<RowFilter> filters_of(const ReadOptions& options, const Dialect& dialect, const LogInfo& info);

/// The first rows know fewer groups of options.kinds.group_by than these.
bool more_groups(const std::vector<Cells>& first, const std::vector<Cells>& more, const ReadOptions& options,
                 const Dialect& dialect, const LogInfo& info);

/// Rows at places all over the file, which are read when they are asked for.
using RowsOfFile = std::function<const Stretches&()>;

/// Fills the groups of options.kinds.group_by from the first `rows` and those of the file; says which that come in turn
/// are stamped apart.
void choose_groups(const std::vector<Cells>& rows, const RowsOfFile& all, const ReadOptions& options, Dialect& dialect,
                   LogInfo& info);

/// Throws Error(input) where a column tells rows of several kinds apart and no option chooses: their stamps go together
/// only by kind, in the first rows or, where its name says kinds, at places all over the file. A column of words that
/// names kinds and holds one only so far has to keep it.
void refuse_long_table(const std::vector<Cells>& rows, const RowsOfFile& all, const std::vector<ColumnKind>& kinds,
                       const ReadOptions& options, Dialect& dialect, const LogInfo& info);

/// The column by which the rows are sorted, so that the time begins again with each of its values.
std::optional<SortedRows> sorted_by(const Stretches& rows, const Dialect& dialect);

}  // namespace libchar::csv
