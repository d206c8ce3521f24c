#pragma once
// What a report found as one table, for a paper or a page: made of an existing report.json.

#include <string>
#include <vector>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/figure/figure_source.hpp"
#include "libchar/replay/report/replay_report.hpp"

namespace libchar {

/// The coefficients of the channels that match one of the patterns (none: all), with 95 % intervals or upper limits.
/// LaTeX is a tabular that needs no package; CSV has one column per number:
/// channel,unit,term,value,low95,high95,upper95,term_unit,status. Throws Error(usage) where a pattern matches no
/// channel.
std::string coefficient_table(const ReportedCharacterization& report, const std::vector<std::string>& channels,
                              TableFormat format);

/// The methods of a replay, best first; bounds are said to be some.
std::string ranking_table(const ReplayReport& report, TableFormat format);

namespace detail {
/// The table of `coefficient_table`, and the fitted channels that match; both throw as that.
Table coefficient_rows(const ReportedCharacterization& report, const std::vector<std::string>& channels);
std::vector<const ReportedChannel*> chosen_channels(const ReportedCharacterization& report,
                                                    const std::vector<std::string>& patterns);

/// A test report to print and sign: object, conditions, method, results with curves, limits, findings. `report` is of
/// a characterization, `document` is its own, its figures are drawn from `source`.
std::string test_form_html(const ReportedCharacterization& report, const Json& document, const FigureSource& source,
                           const std::vector<std::string>& channels);
}  // namespace detail

}  // namespace libchar
