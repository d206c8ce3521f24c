#pragma once
// What every table of methods says alike.

#include "libchar/core/table/table.hpp"

namespace libchar {

/// "RMSE, rad/s", or what is known without a reference.
Table::Column score_column(bool has_reference, const std::string& unit);
Cell regret_cell(double regret);
Cell time_cell(double nanoseconds);
/// NaN: not measured.
Cell memory_cell(double bytes);

}  // namespace libchar
