#include "libchar/report/text/report_table.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"
#include "libchar/report/detail/tables/replay_tables.hpp"

namespace libchar {
namespace {

std::vector<const ReplayReport::Algorithm*> best_first(const ReplayReport& report) {
  std::vector<const ReplayReport::Algorithm*> out;
  for (const ReplayReport::Algorithm& a : report.algorithms)
    if (a.ran) out.push_back(&a);
  std::stable_sort(out.begin(), out.end(), [](const auto* a, const auto* b) {
    return std::isfinite(a->rmse) && (!std::isfinite(b->rmse) || a->rmse < b->rmse);
  });
  return out;
}

}  // namespace

std::vector<const ReportedChannel*> detail::chosen_channels(const ReportedCharacterization& report,
                                                            const std::vector<std::string>& patterns) {
  std::vector<const ReportedChannel*> out;
  std::vector<std::string> names;
  for (const ReportedChannel& channel : report.channels) {
    names.push_back(channel.name);
    if (!channel.fitted) continue;
    if (patterns.empty() ||
        std::any_of(patterns.begin(), patterns.end(), [&](const auto& p) { return matches(p, channel.name); }))
      out.push_back(&channel);
  }
  for (const std::string& pattern : patterns)
    if (std::none_of(names.begin(), names.end(), [&](const auto& name) { return matches(pattern, name); }))
      throw usage_error("E0985", report.file)
          .says("no channel of the report has this name")
          .got(pattern)
          .hint(did_you_mean(nearest(pattern, names), "there are " + first_names(names)));
  if (out.empty())
    throw input_error("E0985", report.file)
        .says("no channel of the report was fitted: there is no coefficient for a table");
  return out;
}

Table detail::coefficient_rows(const ReportedCharacterization& report, const std::vector<std::string>& channels) {
  Table out("channel|", "channel|unit");
  for (const ReportedChannel* channel : chosen_channels(report, channels)) {
    Table one = coefficients_table(channel->term, channel->unit);
    one.drop("best possible");
    one.drop("record for 10 %");
    if (out.columns.size() == 2) out.columns.insert(out.columns.end(), one.columns.begin(), one.columns.end());
    for (Table::Row& row : one.rows) {
      row.cells.back().lines.resize(std::min<std::size_t>(row.cells.back().lines.size(), 1));
      if (std::isfinite(row.cells[2].value)) row.cells[1].low = "95 % upper limit";
      Cell name(&row == &one.rows[0] ? channel->name : "");
      name.data = channel->name;
      row.cells.insert(row.cells.begin(), {std::move(name), channel->unit});
      out.rows.push_back(std::move(row));
    }
  }
  return out;
}

std::string coefficient_table(const ReportedCharacterization& report, const std::vector<std::string>& channels,
                              TableFormat format) {
  return table_text(detail::coefficient_rows(report, channels), format);
}

std::string ranking_table(const ReplayReport& report, TableFormat format) {
  Table out("algorithm||||regret|time per sample|memory", "algorithm|bound||unit|regret|ns_per_sample|peak_bytes");
  const std::string unit = report.inputs.empty() ? "" : report.inputs[0].unit;
  out.columns[2] = score_column(report.reference.has_value(), unit);
  for (const ReplayReport::Algorithm* a : best_first(report)) {
    Cell name(a->label);
    if (a->bound) name.sign = "(bound)";
    out.add({name, a->bound ? "true" : "false", Cell::number(a->rmse, a->rmse_ci95), unit, regret_cell(a->regret),
             time_cell(a->ns_per_sample), memory_cell(a->peak_bytes ? static_cast<double>(*a->peak_bytes) : kNone)});
  }
  return table_text(out, format);
}

}  // namespace libchar
