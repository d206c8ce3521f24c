#pragma once
// Tables in long form, whose rows say whose they are: found, and told apart by options.

#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/head/dialect.hpp"

namespace libchar::csv {

/// The filters of options.kinds.where. Throws Error(usage) for a column that is not there or a word without '='.
std::vector<RowFilter> filters_of(const ReadOptions& options, const Dialect& dialect, const LogInfo& info);

/// The first rows know fewer groups of options.kinds.group_by than these.
bool more_groups(const std::vector<Cells>& first, const std::vector<Cells>& more, const ReadOptions& options,
                 const Dialect& dialect, const LogInfo& info);

/// Fills the groups of options.kinds.group_by from the first `rows`; says which that come in turn are
/// stamped apart. Throws Error(input) when they come one after the other.
void choose_groups(const std::vector<Cells>& rows, const ReadOptions& options, Dialect& dialect, LogInfo& info);

/// Throws Error(input) where a column tells rows of several kinds apart and no option chooses: their stamps go together
/// only by kind. A column that names kinds and holds one only so far has to keep it.
void refuse_long_table(const std::vector<Cells>& rows, const std::vector<ColumnKind>& kinds, const ReadOptions& options,
                       Dialect& dialect, const LogInfo& info);

}  // namespace libchar::csv
