#pragma once
// What a report found as one table, for a paper or a page: made of an existing report.json.

#include <string>
#include <vector>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/replay/report/replay_report.hpp"

namespace libchar {

enum class TableFormat { markdown, latex, csv };
template <>
inline constexpr auto enum_table<TableFormat> =
    enum_words<TableFormat>({{TableFormat::markdown, "markdown"},
                             {TableFormat::latex, "latex"},
                             {TableFormat::csv, "csv"}});

/// The coefficients of the channels that match one of the patterns (none: all), with 95 % intervals or upper limits. LaTeX is a tabular
/// that needs no package; CSV has a column a number: channel,unit,term,value,low95,high95,upper95,term_unit,status. Throws Error(usage)
/// where a pattern matches no channel.
std::string coefficient_table(const ReportedCharacterization& report,
                              const std::vector<std::string>& channels,
                              TableFormat format);

/// The methods of a replay, best first; bounds are said to be some.
std::string ranking_table(const ReplayReport& report, TableFormat format);

/// Text, and a unit, as LaTeX has them: no package, no character beyond ASCII of those that units and numbers here consist of.
std::string latex_text(const std::string& text);
std::string latex_unit(const std::string& unit);

}  // namespace libchar
